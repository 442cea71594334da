/* SPDX-License-Identifier: Apache-2.0
 *
 * volume_wood: wood carved from one block: rings about the z axis of shader space, so that the grain runs through
 * the whole object as it would if it were cut from a trunk.
 *
 * ringscale   rings per unit length
 * wobble      how far from circles the rings are, in units of length
 * grain       strength of the fibres along the axis
 * lightwood, darkwood
 * Ka, Kd, Ks, roughness  reflection
 */
surface volume_wood(float ringscale = 8; float wobble = 0.25; float grain = 0.35;
                    color lightwood = color (0.60, 0.34, 0.14); color darkwood = color (0.26, 0.10, 0.035);
                    float Ka = 1; float Kd = 0.8; float Ks = 0.3; float roughness = 0.04;) {
    point Q = transform("shader", P);
    /* The trunk is neither straight nor round. */
    vector bend = vector noise(Q * 1.3) - 0.5;
    float rx = xcomp(Q) + wobble * xcomp(bend);
    float ry = ycomp(Q) + wobble * ycomp(bend);
    float radius = sqrt(rx * rx + ry * ry) * ringscale + 0.6 * zcomp(bend);
    /* Rings rise slowly and end at once, as wood grows from spring to winter; no two are alike. */
    float ring = mod(radius, 1);
    ring = smoothstep(0, 0.75, ring) * (1 - smoothstep(0.82, 1, ring));
    float year = noise(floor(radius) * 3.7 + 0.5);
    float fibre = noise(point (xcomp(Q) * 45, ycomp(Q) * 45, zcomp(Q) * 3)) - 0.5;
    color wood = mix(lightwood, darkwood, ring * (0.4 + 0.9 * year)) * (1 + grain * 2 * fibre);

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
    Ci = wood * body + Ks * (1 - 0.5 * ring) * shine;
    Oi = 1;
}
