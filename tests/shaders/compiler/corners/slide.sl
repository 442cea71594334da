// warning: texture() is always 1: there are no image textures
light slide(string map = "slide.tx"; float fov = 90; point from = point "shader" (0, 0, -1e6); vector dir = vector "shader" (0, 0, 1);
            vector up = vector "shader" (0, 1, 0);) {
    vector relT, relU = normalize(dir), relV;
    relT = normalize(up ^ relU);
    relV = relU ^ relT;
    float spread = 1 / tan(radians(fov / 2));
    illuminate (from, relU, atan(1.4142136 / spread)) {
        float Pt = L . relT, Pu = L . relU, Pv = L . relV;
        float sloc = spread * Pt / Pu, tloc = spread * Pv / Pu;
        color c = texture(map, sloc * .5 + .5, .5 - tloc * .5);
        Cl = c * color (0, 1, 0);
    }
}
