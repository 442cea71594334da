volume smoke(float density = 1, stepsize = .25; uniform float maxsteps = 20;) {
    point Worigin = P - I;
    point origin = transform("shader", Worigin);
    vector incident = vtransform("shader", I);
    point PP;
    color li = 0, Cv = 0, Ov = 0;
    float ss = min(stepsize, length(incident)), d = random() * ss, steps = 0;
    float end = length(incident) - 0.0001;
    while (d <= end && steps < maxsteps) {
        PP = origin + d * normalize(incident);
        li = 0;
        illuminance (P) li += Cl;
        Ov += (1 - Ov) * ss * density * noise(PP);
        Cv += li;
        d += ss; steps += 1;
    }
    Ci = color (0, steps > 0 && comp(Ov, 0) >= 0, 0) + Cv;
}
