float classify(float x) {
    float i;
    if (x < 3) return 1;
    for (i = 0; i < 20; i += 1) { if (i > x) return 2 + i - i; }
    return 3;
}
surface early_return() {
    if (s > 100) return;
    Ci = color (0, classify(s) == (s < 3 ? 1 : 2), 0);
    if (s > 3) { return; Ci = 1; }
    Ci *= 1;
}
