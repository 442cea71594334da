float near(float a, b) { return abs(a - b) < 0.0001 * (1 + abs(b)); }
surface geometry() {
    vector i = vector (0, 0, 1), x = vector (1, 0, 0), y = vector (0, 1, 0), r, t;
    normal n = normal (0, 0, -1);
    float kr, kt, kr2, kt2;
    fresnel(i, n, 1 / 1.5, kr, kt);
    fresnel(i, n, 1 / 1.5, kr2, kt2, r, t);
    point turned = rotate(point (1, 0, 0), PI / 2, point (0, 0, 0), point (0, 0, 1));
    Ci = color (0, near(kr, 0.04) * near(kr + kt, 1) * near(zcomp(r), -1) * near(zcomp(t), 1)
        * near(ycomp(turned), 1) * (x ^ y == i) * near(x . x, 1) * near(length(x + y), sqrt(2))
        * near(distance(point 0, point (3, 4, 0)), 5) * near(ptlined(point 0, point (1, 0, 0), point (.5, 2, 0)), 2)
        * near(zcomp(reflect(i, n)), -1) * (faceforward(-n, i) == n) * (faceforward(n, -i, n) == -n), 0);
}
