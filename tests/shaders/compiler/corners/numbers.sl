surface numbers() {
    float a = 1., b = .5, c = 1e2, d = 1.5E-1, e = 0005, f = 1.0e+1;
    Ci = color (0, a + b == 1.5 && c == 100 && d == 0.15 && e == 5 && f == 10, 0);
}
