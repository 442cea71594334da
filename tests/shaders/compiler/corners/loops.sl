surface loops() {
    uniform float i, j;
    float n = 0, k = 0;
    for (i = 0, j = 10; i < j; i += 1, j -= 1) n += 1;
    for (uniform float q = 0; q < 3; q += 1) n += 10;
    while (1) { k += 1; if (k > 6) break; if (mod(k, 2) == 0) continue; n += 100; }
    for (;;) { n += 1000; for (;;) break 2; }
    Ci = color (0, n == 1335, 0);
}
