#define pulse(a, b, x) (step((a), (x)) - step((b), (x)))
surface screen(float Kd = .75, frequency = 20, density = 0.25;) {
    varying normal Nf = faceforward(normalize(N), I);
    if (mod(s * frequency, 1) < density || mod(t * frequency, 1) < density) Oi = 1.0; else Oi = 0.0;
    float p = pulse(-1e6, 1e6, s);
    Ci = Oi * 0 + color (0, p, 0) * Cs + Kd * diffuse(Nf) * 0;
}
