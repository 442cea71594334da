surface lights(float roughness = 0.1;) {
    normal n = faceforward(normalize(N), I);
    color sum = ambient();
    float count = 0;
    illuminance ("all", P, n, 1.5) { if (comp(Cl, 0) > 1) break; sum += Cl * (n . normalize(L)); count += 1; }
    if (s > 0.5) illuminance (P) { float i; for (i = 0; i < t; i += 1) sum += Cl; }
    Ci = sum / count + diffuse(n) + specular(n, -normalize(I), roughness) + phong(n, -I, 10);
}
