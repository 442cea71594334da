// warning: trace() is always 0: there is no ray tracing
// warning: trace() is always 0: there is no ray tracing
// warning: environment() is always 0: there are no image textures
surface glass(float Kr = 1, eta = 1.5; string envname = "";) {
    normal Nn = normalize(N);
    vector In = normalize(I), R, T;
    float kr, kt, enter = (In . Nn <= 0) ? 1 / eta : eta;
    fresnel(In, faceforward(Nn, In), enter, kr, kt, R, T);
    color Crefl = Kr * kr * trace(P, R), Crefr = kt * trace(P, T);
    if (envname != "") Crefl += color environment(envname, vtransform("world", R));
    Ci = Crefl + Crefr + color (0, kr + kt > 0.999, 0);
}
