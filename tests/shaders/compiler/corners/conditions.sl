surface conditions() {
    float a = 3, b = 0;
    float r = a > 2 && !b ? 1 : 0;
    if (a) if (b) r = 9; else r += 1;
    if (!(a == 3 || b != 0)) r = 9;
    r += (a >= 3) + (a <= 2);
    Ci = (r == 3) ? color (0, 1, 0) : color (1, 0, 0);
}
