/* SPDX-License-Identifier: Apache-2.0
 *
 * simple_brick: a wall of bricks in running bond, after figure 3 of Olano and Lastra, "A Shading Language on
 * Graphics Hardware: The PixelFlow Shading System" (1998). Texture coordinates are wrapped to coordinates of one
 * brick, (0, 0) in its lower left corner, which decide between brick and mortar.
 *
 * width, height  of a brick with its mortar, in s and t
 * mortar         width of the mortar
 * brickcolor, mortarcolor
 * edge           over which width an edge is softened
 * Ka, Kd         how much ambient light and light sources count
 */
surface simple_brick(float width = 0.25; float height = 0.1; float mortar = 0.012;
                     color brickcolor = color (0.52, 0.17, 0.11);
                     color mortarcolor = color (0.62, 0.58, 0.52);
                     float edge = 0.003; float Ka = 1; float Kd = 0.9;) {
    /* which row of bricks this is; every second row is offset by half a brick */
    float row = floor(t / height);
    float ss = s;
    if (mod(row, 2) == 0)
        ss += width / 2;
    /* wrap texture coordinates to get brick coordinates */
    ss = mod(ss, width);
    float tt = mod(t, height);
    /* pick a color for the surface: mortar lies left of and below the brick */
    float in_brick = smoothstep(mortar - edge, mortar + edge, ss) * (1 - smoothstep(width - edge, width, ss)) *
                     smoothstep(mortar - edge, mortar + edge, tt) * (1 - smoothstep(height - edge, height, tt));
    color surface_color = mix(mortarcolor, brickcolor, in_brick);
    normal Nf = faceforward(normalize(N), I);
    Ci = surface_color * (Ka * ambient() + Kd * diffuse(Nf));
    Oi = 1;
}
