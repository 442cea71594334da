float total(float a[]; float n) { float i, sum = 0; for (i = 0; i < n; i += 1) sum += a[i]; return sum; }
surface arrays(float k[3] = {1, 2, 3}; color c[2] = {1, color (0, 1, 0)};) {
    float a[4]; point p[2];
    a[s] = t; a[0] += k[1]; p[1] = P; p[u] -= point (1, 2, 3);
    if (s > 1) a[2] = 5;
    Ci = c[a[1]] * total(a, 4) * xcomp(p[1]) + comp(c[0], s);
}
