surface position_of_light() {
    point PP = P + vector (0, 1, 0);
    color c = 0;
    illuminance (PP, N, PI) c += Cl;
    P += normalize(N);
    illuminance (P) c += Cl;
    Ci = c + color (0, 1, 0);
}
