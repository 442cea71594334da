/* SPDX-License-Identifier: Apache-2.0
 *
 * plastic: a diffuse body under a clear coat with highlights of another color. One pass over the lights does
 * both, so that each direction is normalized once.
 *
 * Ka, Kd         how much ambient light and light sources count in the body
 * Ks             strength of the highlights
 * roughness      their size
 * specularcolor  their color
 */
surface plastic(float Ka = 1; float Kd = 0.5; float Ks = 0.5; float roughness = 0.1;
                color specularcolor = 1;) {
    normal Nf = faceforward(normalize(N), I);
    vector V = -normalize(I);
    color body = Ka * ambient();
    color shine = 0;
    illuminance (P) {
        vector Ln = normalize(L);
        float facing = Nf . Ln;
        float spread = max(0, Nf . normalize(Ln + V));
        body += Kd * max(0, facing) * Cl;
        shine += (facing > 0 ? pow(spread, 1 / roughness) : 0) * Cl;
    }
    Oi = Os;
    Ci = Os * (Cs * body + Ks * specularcolor * shine);
}
