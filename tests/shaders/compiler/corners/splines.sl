surface splines(string basis = "linear"; float knots[6] = {0, 0, .25, .5, 1, 1};) {
    color hot = spline(0.5, color 0, color (0, 0, 0), color (0, 1, 0), color (0, 2, 0), color (0, 3, 0));
    float a = spline("linear", 0.5, 0, 0, 1, 2, 2), b = spline("bezier", 0, 1, 2, 3, 4), c = spline("bspline", 0, 2, 2, 2, 2);
    float d = spline("hermite", 1, 0, 1, 3, 1), e = spline("linear", 0.5, knots), g = spline(basis, 1, 0, 0, 7, 7);
    point p = spline(0, point 0, point (1, 2, 3), point 0, point 0);
    Ci = color (0, abs(a - 1) < .001 && abs(b - 1) < .001 && abs(c - 2) < .001 && abs(d - 3) < .001 && e > .3 && g == 7
                   && distance(p, point (1, 2, 3)) < .001 && abs(comp(hot, 1) - 1) < .001, 0);
}
