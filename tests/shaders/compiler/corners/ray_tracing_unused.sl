/* headers bring functions that nobody calls */
color bounce(point p; vector d) { return indirectdiffuse(p, normal d, 64) + transmission(p, p + d); }
float dark(point p; normal n) {
    float hits = 0;
    gather ("illuminance", p, n, PI / 2, 16) hits += 0; else hits += 1;
    return hits + occlusion(p, n, 16);
}
surface ray_tracing_unused() { Ci = color (0, 1, 0); }
