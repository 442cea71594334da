surface lighting(float Ka = 1, Kd = .5, Ks = .5, roughness = .1; color specularcolor = 1;) {
    normal Nf = faceforward(normalize(N), I);
    vector V = -normalize(I);
    color mine = 0, c;
    illuminance (P, Nf, PI / 2) { vector Ln = normalize(L); mine += Cl * (Ln . Nf) + Cl * specularbrdf(Ln, Nf, V, roughness); }
    c = Cs * (Ka * ambient() + Kd * diffuse(Nf)) + specularcolor * (Ks * specular(Nf, V, roughness) + phong(Nf, V, 10)) + mine;
    Ci = color (0, 1, 0) + c; /* there is no light here */
}
