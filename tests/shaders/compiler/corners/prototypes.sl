float later(float x);
surface prototypes() {
    color vivid(float x);
    color vivid(float x) { return color (0, x, 0); }
    Ci = vivid(later(0));
}
float later(float x) { return x + 1; }
