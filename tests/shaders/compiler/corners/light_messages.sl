// warning: what illuminance is told here has no effect
surface light_messages(string where = "fill";) {
    color c = 0;
    float nondiffuse = 0, known = 0;
    illuminance ("specular,-rim", P, normalize(N), PI / 2, "lightcache", "reuse") {
        known += lightsource("__nondiffuse", nondiffuse);
        if (nondiffuse == 0) c += Cl;
    }
    illuminance ("-rim", P) c += Cl;
    Ci = c + color (0, 1 - known, 0);
}
