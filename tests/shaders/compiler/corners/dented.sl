displacement dented(float Km = 1.0; output varying float ok = 0;) {
    float size = 1, magnitude = 0, i;
    point P2 = transform("shader", P);
    for (i = 0; i < 6; i += 1.0) { magnitude += abs(.5 - noise(P2 * size)) / size; size *= 2.0; }
    vector d = vector "shader" (0, 0, 1) * pow(magnitude, 3) * Km;
    P -= normalize(N) * length(d);
    normal old = normalize(N), fresh = normalize(calculatenormal(P));
    N = fresh + (old - normalize(Ng));
    ok = magnitude >= 0 && N . old > -1.001;
}
