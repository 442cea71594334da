surface expressions() {
    float a, b, c;
    a = b = c = 2;
    vector v = (1, 2, 3), w = (0, 0, 1);
    float d = v . w * 2, e = 10 - 4 - 3, f = 2 + 3 * 4, g = -v . w;
    point p = (1, 2, 3);
    p = (p + v) / 2;
    p += (2, 4, 6) * .5 - (1, 2, 3);
    color k = (0, 1, 0);
    k *= 2; k /= 2; k += 0; k -= 0;
    Ci = (a + b + c == 6 && d == 6 && e == 3 && f == 14 && g == -3 && p == point (1, 2, 3) && (v ^ w) . v == 0) ? k : color 1;
}
