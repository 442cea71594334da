surface control(float n = 3; varying float w = 1;) {
    float i, j, x = 0;
    for (i = 0; i < n; i += 1) {
        if (i == w) continue;
        for (j = 0; j < s; j += 1) { if (j > 2) break 2; if (x > t) continue 2; x += j; }
        while (x < 4) { x *= 2; if (x > 3) return; }
    }
    if (x > 1 && s < 2 || !(t == 3)) x = -x; else if (u != v) x -= 1;
    Ci = x > 0 ? color noise(P) : color (x, s, t) * (vector (1, 2, 3) . N);
}
