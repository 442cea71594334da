displacement lift(float Km = 0.1; string space = "shader"; output varying float ok = 0;) {
    vector Nn = normalize(N);
    float amp = Km * noise(transform(space, P));
    point before = P;
    P += amp * Nn;
    N = calculatenormal(P);
    ok = distance(before, P) <= Km + 0.001;
}
