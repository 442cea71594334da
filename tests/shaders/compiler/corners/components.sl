surface components() {
    color c = 0;
    point p = 0;
    uniform float i;
    for (i = 0; i < 3; i += 1) setcomp(c, i, i + 1);
    setcomp(c, s, comp(c, s));
    setxcomp(p, 1); setycomp(p, 2); setzcomp(p, 3);
    Ci = color (0, comp(c, 0) == 1 && comp(c, 2) == 3 && comp(c, 9) == 3 && p == point (1, 2, 3), 0);
}
