/* SPDX-License-Identifier: Apache-2.0
 *
 * marble: veins where a turbulent sine crosses its peaks.
 *
 * veins      veins per unit length, in shader space
 * octaves    of turbulence
 * strength   how far turbulence pulls the veins
 * pale, dark, tint  colors of stone, vein and the clouds between
 * Ka, Kd, Ks, roughness  reflection of the polished stone
 */
float turbulence(point p; float octaves) {
    float sum = 0;
    float size = 1;
    point q = p;
    float i;
    for (i = 0; i < octaves; i += 1) {
        sum += abs(noise(q) - 0.5) * size;
        size *= 0.5;
        q *= 2;
    }
    return 2 * sum;
}

surface marble(float veins = 2; float octaves = 6; float strength = 1.5;
               color pale = color (0.80, 0.78, 0.74); color dark = color (0.06, 0.05, 0.08);
               color tint = color (0.50, 0.42, 0.36);
               float Ka = 1; float Kd = 0.8; float Ks = 0.5; float roughness = 0.02;) {
    point Q = transform("shader", P) * veins;
    float cloud = turbulence(Q, octaves);
    float wave = 0.5 + 0.5 * sin(3.14159265 * (xcomp(Q) + 0.4 * ycomp(Q) + strength * cloud));
    /* thin veins: the eighth power by squaring, cheaper than pow */
    float vein = wave * wave;
    vein *= vein;
    vein *= vein;
    color stone = mix(mix(pale, tint, smoothstep(0.25, 1.1, cloud)), dark, 0.85 * vein);

    normal Nf = faceforward(normalize(N), I);
    vector V = -normalize(I);
    color body = Ka * ambient();
    color shine = 0;
    illuminance (P) {
        vector Ln = normalize(L);
        float facing = max(0, Nf . Ln);
        body += Kd * facing * Cl;
        shine += pow(max(0, Nf . normalize(Ln + V)), 1 / roughness) * smoothstep(0, 0.05, facing) * Cl;
    }
    Ci = stone * body + Ks * shine;
    Oi = 1;
}
