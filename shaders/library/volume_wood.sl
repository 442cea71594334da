/* SPDX-License-Identifier: Apache-2.0
 *
 * volume_wood: wood carved from one block: rings about an axis of shader space, so that the grain runs through
 * the whole object as it would if it were cut from a trunk.
 *
 * ringscale   rings per unit length
 * wobble      how far from circles the rings are
 * grain       strength of the fibres along the axis
 * lightwood, darkwood
 * Ka, Kd, Ks, roughness  reflection
 */
surface volume_wood(float ringscale = 8; float wobble = 0.25; float grain = 0.35;
                    color lightwood = color (0.72, 0.48, 0.25); color darkwood = color (0.38, 0.19, 0.08);
                    float Ka = 1; float Kd = 0.75; float Ks = 0.3; float roughness = 0.12;) {
    point Q = transform("shader", P);
    /* the trunk is neither straight nor round */
    vector bend = vector noise(Q * 1.3) - 0.5;
    point R = Q + wobble * bend;
    float radius = sqrt(xcomp(R) * xcomp(R) + ycomp(R) * ycomp(R));
    float ring = mod(radius * ringscale, 1);
    ring = smoothstep(0, 0.75, ring) * (1 - smoothstep(0.85, 1, ring));
    float fibre = noise(point (xcomp(Q) * 60, ycomp(Q) * 60, zcomp(Q) * 3));
    color wood = mix(lightwood, darkwood, ring) * (1 - grain * (fibre - 0.5));
    normal Nf = faceforward(normalize(N), I);
    vector V = -normalize(I);
    Ci = wood * (Ka * ambient() + Kd * diffuse(Nf)) + Ks * (1 - 0.5 * ring) * specular(Nf, V, roughness);
    Oi = 1;
}
