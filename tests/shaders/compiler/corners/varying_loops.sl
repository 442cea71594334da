surface varying_loops() {
    float i = 0, sum = 0;
    while (i < s) { i += 1; if (i == 5) continue; if (i > 9) break; sum += i; }
    float m = min(s, 9), expected = m * (m + 1) / 2 - (m >= 5 ? 5 : 0);
    Ci = color (0, abs(sum - expected) < 0.001, 0);
}
