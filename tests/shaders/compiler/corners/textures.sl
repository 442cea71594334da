// warning: texture() is always 1: there are no image textures
// warning: texture() is always 1: there are no image textures
// warning: texture() is always 1: there are no image textures
// warning: environment() is always 0: there are no image textures
// warning: shadow() is always 0: there are no shadows
// warning: bump() is always 0: there are no image textures
// warning: textureinfo() is always 0: there are no image textures
// warning: trace() is always 0: there is no ray tracing
surface textures(string texturename = ""; string maps[2] = {"a", "b"}; float blur = 0;) {
    float ss = s, tt = t, resolution[2];
    color c = color (1, 1, 1);
    float opacity = 1;
    if (texturename != "") {
        c = texture(texturename, ss, tt, "swidth", 1, "blur", blur, "filter", "gaussian");
        opacity = float texture(texturename[3], ss, tt);
    }
    float m = texture(maps[1][0], ss, tt, ss + 1, tt, ss, tt + 1, ss + 1, tt + 1);
    color e = environment("sky.env", reflect(I, N), "fov", 30);
    float dark = shadow("sun.shd", P, "samples", 16, "bias", 0.01);
    point b = bump("dents.bmp", N, dPdu, dPdv);
    if (textureinfo("a", "resolution", resolution) == 0) m += 0;
    color r = trace(P, reflect(I, N));
    Ci = color (0, m, 0) * c * opacity + e + dark + r + xcomp(b);
}
