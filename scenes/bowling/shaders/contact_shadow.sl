/* SPDX-License-Identifier: Apache-2.0
 *
 * contact_shadow: a light that takes light away, where things stand on the lane. This machine casts no shadows; but
 * ten pins stand on a known lattice, so that the nearest one is found by rounding, all ten for the price of one.
 * Give it only to the floor.
 *
 * Shader space: the head pin stands at the origin, the rows follow along z, the floor is y = 0.
 *
 * intensity          how much light is taken away at the foot of a pin, as ambient light
 * spacing            between neighbouring pins
 * footradius, reach  of a pin; how far from it its shadow has faded
 * leanx, leanz       how the shadow leans away from the light
 * ballx, ballz, ballreach  where the ball touches the floor, and how far its shadow goes
 */
float blot(float x; float z; float leanx; float leanz; float near; float far) {
    /* A distance that grows more slowly on the side that the shadow leans to. */
    float lean = max(0, x * leanx + z * leanz);
    float d = sqrt(x * x + z * z) - 0.5 * lean;
    return 1 - smoothstep(near, far, d);
}

light contact_shadow(float intensity = 0.5; color lightcolor = 1; float spacing = 12;
                     float footradius = 1; float reach = 4; float leanx = -0.4; float leanz = 0.9;
                     float ballx = 0; float ballz = -30; float ballreach = 6;) {
    point Q = transform("shader", Ps);
    float x = xcomp(Q);
    float z = zcomp(Q);
    uniform float pitch = spacing * 0.8660254;
    /* the nearest row, and the nearest of the pins in it: row 0 has one, row 3 has four */
    float row = clamp(floor(z / pitch + 0.5), 0, 3);
    float first = -0.5 * row * spacing;
    float pin = clamp(floor((x - first) / spacing + 0.5), 0, row);
    float dark = blot(x - first - pin * spacing, z - row * pitch, leanx, leanz, footradius * 0.6, reach);
    dark = max(dark, blot(x - ballx, z - ballz, leanx, leanz, 0, ballreach));
    Cl = -intensity * dark * lightcolor;
}
