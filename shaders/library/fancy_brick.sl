/* SPDX-License-Identifier: Apache-2.0
 *
 * fancy_brick: the wall of simple_brick grown more realistic: bricks are rounded and mortar is indented by a
 * procedural bump map, both are grainy, colors swirl through the clay of each brick, and no two bricks have the same
 * tone. Swirls and grains are measured in brick heights, so that a wall looks the same in inches, feet or metres.
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
/* Across one brick: 0 in the mortar, 1 on the brick; `slope` is -1, 0 or 1 where it rises, is flat or falls. */
float profile(float x; float size; float mortar; float bevel; output float slope) {
    float centred = x - size / 2;
    float ramp = (size / 2 - mortar / 2 - abs(centred)) / bevel;
    slope = ramp > 0 && ramp < 1 ? sign(centred) : 0;
    return clamp(ramp, 0, 1);
}

surface fancy_brick(float width = 0.25; float height = 0.1; float mortar = 0.012;
                    color brickcolor = color (0.52, 0.17, 0.11);
                    color mortarcolor = color (0.62, 0.58, 0.52);
                    float bevel = 0.008; float depth = 0.7; float grain = 0.35; float swirl = 0.4;
                    float variation = 0.35; float Ka = 1; float Kd = 0.9;) {
    /* texture coordinates in brick heights; grain of two sizes, which also frays the edges of the bricks */
    float a = s / height;
    float b = t / height;
    float fine = noise(a * 22, b * 22) - 0.5;
    float coarse = noise(a * 7, b * 7) - 0.5;

    float row = floor(b);
    float ss = s + (mod(row, 2) == 0 ? width / 2 : 0);
    float column = floor(ss / width);
    float fray = 0.5 * bevel * coarse;
    float slope_s, slope_t;
    float on_s = profile(ss - column * width + fray, width, mortar, bevel, slope_s);
    float on_t = profile(t - row * height + fray, height, mortar, bevel, slope_t);
    float on_brick = smoothstep(0.1, 0.9, min(on_s, on_t));

    /* one tone per brick, and swirls that do not run on from brick to brick */
    float tone = noise(column * 7.13 + 0.5, row * 5.77 + 0.5) - 0.5;
    float around = noise(a * 1.3 + column * 3.7, b * 1.3 + row * 9.1);
    float streaks = noise(a * 2 + around * 5, b * 4 + around * 3 + row * 4.3) - 0.5;
    color clay = brickcolor * (1 + variation * 2 * tone + swirl * 2 * streaks);
    color joint = mortarcolor * (1 + 0.4 * coarse);
    color surface_color = mix(joint, clay, on_brick) * (1 + grain * (fine + coarse));

    /* Tip the normal outwards where a brick is rounded, and a little at random for the grain. */
    float rounded = depth * (1 - on_brick);
    normal bumped = normalize(N) + normalize(dPdu) * (rounded * slope_s + grain * fine) +
                    normalize(dPdv) * (rounded * slope_t + grain * coarse);
    normal Nf = faceforward(normalize(bumped), I);
    Ci = max(color 0, surface_color) * (Ka * ambient() + Kd * diffuse(Nf));
    Oi = 1;
}
