float fact(float n) { float i, r = 1; for (i = 2; i <= n; i += 1) r *= i; return r; }
color early(color c; float k) { if (k < 0) return 0; if (k > 1) { return 1; } return c * k; }
void pair(uniform float u_; float x; output float a, b) { a = x + u_; b = a * x; }
surface functions(string space = "shader"; float k = 4;) {
    float a, b;
    vector inner(vector d) { extern float a; return normalize(d) * a; }
    pair(k, s, a, b);
    point q = transform(space, P);
    setycomp(q, b);
    Ci = early(color (inner(q)), fact(k) * b) + ctransform("hsv", color (a, b, s)) + color (refract(I, N, 1.5));
}
