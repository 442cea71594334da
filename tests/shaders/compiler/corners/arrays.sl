float sum(float a[]; float n) { float i, s = 0; for (i = 0; i < n; i += 1) s += a[i]; return s; }
surface arrays(float weights[4] = {1, 2, 3, 4}; color tints[2] = {color (1, 0, 0), color (0, 1, 0)};) {
    float copy[4], odd[] = {1, 3, 5};
    point corners[3];
    copy = weights;
    copy[s] = copy[s] + 0;
    corners[1] = P;
    corners[1] += vector (1, 0, 0);
    setxcomp(corners[2], 5);
    Ci = tints[1];
    if (sum(copy, 4) != 10 || sum(odd, 3) != 9 || corners[1] != P + vector (1, 0, 0) || xcomp(corners[2]) != 5)
        Ci = 1;
}
