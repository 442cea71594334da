float kind(float x) { return 1; }
float kind(color x) { return 2; }
float kind(point x; float y) { return 3; }
surface overloading() {
    point p = 2 * noise(P * .37 + .1);
    float f = noise(P);
    color c = noise(s, t);
    Ci = color (0, kind(f) + kind(c) + kind(P, 1) == 6 && xcomp(p) != ycomp(p) && f >= 0 && f <= 1, 0);
}
