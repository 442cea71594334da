float inside(float x) { return x >= 0 && x <= 1; }
surface noises() {
    float ok = inside(noise(s)) * inside(noise(s, t)) * inside(noise(P)) * inside(noise(P, s));
    ok *= inside(cellnoise(s)) * inside(cellnoise(P)) * (cellnoise(floor(s) + .1) == cellnoise(floor(s) + .9));
    ok *= abs(pnoise(s, 4) - pnoise(s + 4, 4)) < 0.0001;
    color c = color noise(P); point p = point noise(s, t); vector v = vector cellnoise(P); color pc = pnoise(P, point (2, 3, 4));
    float r = random();
    ok *= inside(r) * inside(comp(c, 1)) * inside(xcomp(p)) * inside(xcomp(v)) * inside(comp(pc, 0));
    Ci = color (0, ok, 0);
}
