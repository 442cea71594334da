float filteredpulse(float edge0, edge1, x, dx) {
    float x0 = x - dx / 2, x1 = x0 + dx;
    return max(0, (min(x1, edge1) - max(x0, edge0)) / dx);
}
surface antialiased_step() {
    float dx = filterwidth(s);
    float a = filteredpulse(-100, 100, s, dx), b = filterstep(-100, s), c = filterstep(-50, s, s + 1, "filter", "box");
    Ci = color (0, (a + b + c) / 3, 0);
}
