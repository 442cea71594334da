/* SPDX-License-Identifier: Apache-2.0
 *
 * metal: highlights in the color of the surface, no diffuse reflection.
 *
 * Ka         how much ambient light counts
 * Ks         strength of the highlights
 * roughness  their size
 */
surface metal(float Ka = 1; float Ks = 1; float roughness = 0.1;) {
    normal Nf = faceforward(normalize(N), I);
    vector V = -normalize(I);
    Oi = Os;
    Ci = Os * Cs * (Ka * ambient() + Ks * specular(Nf, V, roughness));
}
