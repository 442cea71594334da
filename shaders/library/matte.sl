/* SPDX-License-Identifier: Apache-2.0
 *
 * matte: an ideally diffuse surface.
 *
 * Ka  how much ambient light counts
 * Kd  how much light from light sources counts
 */
surface matte(float Ka = 1; float Kd = 1;) {
    normal Nf = faceforward(normalize(N), I);
    Oi = Os;
    Ci = Os * Cs * (Ka * ambient() + Kd * diffuse(Nf));
}
