void voronoi(point p; float jitter; output float f1; output point pos1;) {
    point thiscell = point (floor(xcomp(p)) + .5, floor(ycomp(p)) + .5, floor(zcomp(p)) + .5);
    f1 = 1000;
    uniform float i, j, k;
    for (i = -1; i <= 1; i += 1)
        for (j = -1; j <= 1; j += 1)
            for (k = -1; k <= 1; k += 1) {
                point testcell = thiscell + vector (i, j, k);
                point pos = testcell + jitter * (vector cellnoise(testcell) - .5);
                vector offset = pos - p;
                float dist = offset . offset;
                if (dist < f1) { f1 = dist; pos1 = pos; }
            }
    f1 = sqrt(f1);
}
surface voronoi_cells() {
    float f; point c;
    voronoi(P, 0.5, f, c);
    Ci = color (0, f < 2 && abs(distance(c, P) - f) < 0.001, 0);
}
