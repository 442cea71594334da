surface casts() {
    color c = color "rgb" 0.5, h = color "hsv" (1 / 3, 1, 1), l = color "hsl" (1 / 3, 1, 0.5);
    color y = ctransform("rgb", "YIQ", 1), x = ctransform("xyz", ctransform("rgb", "xyz", c));
    point p = point "shader" (1, 2, 3);
    vector v = vector "world" (0, 1, 0);
    normal n = normal (v);
    float f = float (3), g = float noise(P), b = s > 1;
    color fromp = color (p);
    Ci = h;
    if (distance(point (h), point (l)) > 0.001 || abs(comp(y, 0) - 1) > 0.001 || comp(fromp, 2) != 3 || f != 3)
        Ci = 1;
}
