/* SPDX-License-Identifier: Apache-2.0
 *
 * fancy_brick: the wall of simple_brick grown more realistic: the mortar is indented by a procedural bump map,
 * bricks and mortar are grainy, colors swirl through the clay of each brick, and no two bricks have the same tone.
 *
 * width, height, mortar    as in simple_brick
 * brickcolor, mortarcolor
 * bevel       how wide the rounding of a brick's edges is
 * depth       how steep it is, 0 for flat
 * grain       strength of the grains
 * swirl       strength of the swirls within a brick
 * variation   how much bricks differ
 * Ka, Kd      how much ambient light and light sources count
 */
/* A ramp up from `low`, flat, and a ramp down to `high`: 1 inside, 0 outside; `slope` is -1, 0 or 1. */
float tile(float x; float low; float high; float bevel; output float slope) {
    float up = clamp((x - low) / bevel, 0, 1);
    float down = clamp((high - x) / bevel, 0, 1);
    slope = (up > 0 && up < 1 ? 1 : 0) - (down > 0 && down < 1 ? 1 : 0);
    return min(up, down);
}

surface fancy_brick(float width = 0.25; float height = 0.1; float mortar = 0.012;
                    color brickcolor = color (0.52, 0.17, 0.11);
                    color mortarcolor = color (0.62, 0.58, 0.52);
                    float bevel = 0.008; float depth = 0.7; float grain = 0.35; float swirl = 0.4;
                    float variation = 0.35; float Ka = 1; float Kd = 0.9;) {
    float row = floor(t / height);
    float ss = s + (mod(row, 2) == 0 ? width / 2 : 0);
    float column = floor(ss / width);
    float x = ss - column * width;
    float y = t - row * height;
    float slope_s, slope_t;
    float inside_s = tile(x, mortar / 2, width - mortar / 2, bevel, slope_s);
    float inside_t = tile(y, mortar / 2, height - mortar / 2, bevel, slope_t);
    float in_brick = smoothstep(0.1, 0.9, min(inside_s, inside_t));

    /* one tone per brick, swirls that differ from brick to brick, and two sizes of grain */
    float tone = noise(column * 7.13 + 0.5, row * 5.77 + 0.5) - 0.5;
    float around = noise(s * 18 + column * 3.7, t * 18 + row * 9.1);
    float streaks = noise(s * 30 + around * 6, t * 45 + around * 4) - 0.5;
    float fine = noise(s * 260, t * 260) - 0.5;
    float coarse = noise(s * 90, t * 90) - 0.5;
    color clay = brickcolor * (1 + variation * 2 * tone + swirl * 2 * streaks);
    color joint = mortarcolor * (1 + 0.3 * coarse);
    color surface_color = mix(joint, clay, in_brick) * (1 + grain * (fine + coarse));

    /* tip the normal outwards where a brick is rounded, a little at random for the grain */
    vector across = normalize(dPdu);
    vector along = normalize(dPdv);
    normal Nn = normalize(N);
    float edge = 1 - in_brick;
    vector bump = across * (-depth * slope_s * edge + grain * fine) + along * (-depth * slope_t * edge + grain * coarse);
    normal Nf = faceforward(normalize(Nn + bump), I);
    Ci = max(color 0, surface_color) * (Ka * ambient() + Kd * diffuse(Nf));
    Oi = 1;
}
