/* SPDX-License-Identifier: Apache-2.0 */
/* The surface of primitives without one: lit from the eye, so that shapes can be made out without any light. */
surface defaultsurface(float Kd = 0.8; float Ka = 0.2) {
    float facing = abs(normalize(N) . normalize(I));
    Ci = Cs * (Ka + Kd * facing);
    Oi = Os;
}
