/* SPDX-License-Identifier: Apache-2.0 */
matrix turn(matrix m; float angle) { if (angle > 1) return m; return rotate(m, angle, vector (0, 0, 1)); }
void change(output matrix m; float k) { setcomp(m, k, 2, comp(m, 0, k)); m /= 2; }
surface matrices(float k = 2;) {
    matrix m = (1, 0, 0, 0,  0, k, 0, 0,  s, 0, 1, 0,  0, 0, 0, 1), n = matrix "shader" 1;
    change(m, s);
    n *= s > t ? m : turn(scale(translate(m, P), (1, 2, 3)), t);
    while (determinant(n) > 2) n = n / m * 0.5;
    Ci = color (transform(n, P)) + color (vtransform(m, I)) + color (ntransform(m, N));
}
