surface spaces(string space = "shader"; point centre = point "world" (0, 0, 0); vector up = vector "object" (0, 1, 0);) {
    point p = transform(space, P), q = transform("world", "shader", P), n = transform("NDC", P), m = transform("my system", P);
    vector v = vtransform("current", "object", up);
    normal k = ntransform(space, N);
    Ci = color (0, p == P && q == P && m == P && v == up && k == N && centre == point 0 && xcomp(n) == xcomp(P), 0);
}
