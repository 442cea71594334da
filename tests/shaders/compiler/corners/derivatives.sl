#define MINFILTWIDTH 1.0e-6
#define filterwidth(x) max (abs(Du(x) * du) + abs(Dv(x) * dv), MINFILTWIDTH)
#define filterwidthp(p) max (sqrt(area(p)), MINFILTWIDTH)
surface derivatives() {
    float w = filterwidth(3 * s), wp = filterwidthp(P);
    normal n = calculatenormal(P);
    float d = Deriv(6 * s, s);
    Ci = color (0, abs(w - 3) < 0.001 && abs(wp - 1) < 0.001 && n . N > 0 && abs(length(Du(P)) - 1) < 0.001 && d > 5.99, 0);
}
