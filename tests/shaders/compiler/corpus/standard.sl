/* SPDX-License-Identifier: Apache-2.0 */
surface standard(string map = concat("a", ".tif"); float knots[] = {0, 1, 0, 1}; point axis = (0, 0, 1);) {
    float kr, kt, k = PI;
    vector r, t1;
    fresnel(normalize(I), normalize(N), 1.5, kr, kt, r, t1);
    color c = spline(noise(P, s), color (1, 0, 0), (0, 1, 0), (0, 0, 1), (1, 1, 1), (0, 0, 0));
    c += color texture(map[0], s, t, "blur", 0.1) * environment("sky", r);
    c *= spline("bezier", s, knots) + spline("hermite", t, 0, 1, 2, 3, 4, 5);
    point q = rotate(P, pnoise(s, 4), point (0, 0, 0), axis);
    c += color cellnoise(q, s) * ptlined(q, P, axis) + pnoise(q, t, point (1, 2, 3), 4);
    c += ctransform("YIQ", "xyz", c) * color random() * random();
    k += surface("k", k) + attribute("name", map) + match(map, "x");
    printf("%f %c\n", k, c);
    Ci = c * kr + k;
}
