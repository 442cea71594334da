/* SPDX-License-Identifier: Apache-2.0
 *
 * mirrored_pins: a light that paints, on a polished lane, the mirror images of ten pins and a ball. Nothing here
 * traces rays; but what the eye would see in a level mirror is what stands upside down below it, and ten pins that
 * stand in four rows are four pictures one behind another. Give it only to the floor.
 *
 * Shader space: the head pin stands at the origin, the rows follow along z, the floor is y = 0.
 *
 * intensity, lightcolor   of white in the mirror, as ambient light
 * pincolor, stripecolor, ballcolor
 * spacing                 between neighbouring pins
 * tall                    how tall they are
 * ballx, ballz, ballradius
 */
/* How wide a pin of height 1 is at a height: a belly and a head on a neck. */
float pin_radius(float y) {
    float belly = (y - 0.30) / 0.30;
    float head = (y - 0.89) / 0.15;
    return 0.058 + 0.095 * max(0, 1 - belly * belly) + 0.026 * max(0, 1 - head * head);
}

light mirrored_pins(float intensity = 0.5; color lightcolor = 1; color pincolor = color (0.9, 0.9, 0.9);
                    color stripecolor = color (0.6, 0.05, 0.05); color ballcolor = color (0.03, 0.08, 0.2);
                    float spacing = 12; float tall = 15;
                    float ballx = 0; float ballz = -30; float ballradius = 4.25;) {
    uniform point eye = transform("shader", point (0, 0, 0));
    uniform float ex = xcomp(eye);
    uniform float ey = ycomp(eye);
    uniform float ez = zcomp(eye);
    point Q = transform("shader", Ps);
    float dx = xcomp(Q) - ex;
    float per_z = 1 / max(zcomp(Q) - ez, 0.001);
    color seen = 0;
    float row;
    for (row = 3; row >= 0; row -= 1) {
        /* where the line of sight, on its way down, passes below the row */
        float far = (row * spacing * 0.8660254 - ez) * per_z;
        float y = ey * (far - 1) / tall;
        float x = (ex + far * dx) / spacing + 0.5 * row;
        float off = abs(x - clamp(floor(x + 0.5), 0, row)) * spacing / tall;
        /* The higher up the image, the more the lane blurs it. */
        float soft = 0.006 + 0.025 * max(y, 0);
        float radius = pin_radius(y);
        float here = (1 - smoothstep(radius - soft, radius + soft, off)) * (1 - smoothstep(0.97 - soft, 1.02, y)) *
                     smoothstep(-0.01, 0.01, y);
        float stripe = 1 - smoothstep(0.01, 0.04, abs(abs(y - 0.6725) - 0.0475));
        seen = mix(seen, (1 - 0.7 * y) * mix(pincolor, stripecolor, stripe), here);
    }
    float far = (ballz - ez) * per_z;
    float bx = (ex + far * dx - ballx) / ballradius;
    float by = ey * (far - 1) / ballradius - 1;
    float ball = (1 - smoothstep(0.9, 1.08, sqrt(bx * bx + by * by)));
    seen = mix(seen, ballcolor, ball);
    Cl = intensity * lightcolor * seen;
}
