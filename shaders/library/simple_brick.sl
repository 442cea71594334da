/* SPDX-License-Identifier: Apache-2.0
 *
 * simple_brick: a wall of bricks in running bond, figure 3 of Olano and Lastra, "A Shading Language on Graphics
 * Hardware: The PixelFlow Shading System" (1998), in its own types: texture coordinates and sizes are 16-bit
 * fixed-point, the row of bricks is an 8-bit integer, colors are arrays. Texture coordinates are wrapped to
 * coordinates of one brick, (0, 0) in its lower left corner, which decide between brick and mortar. The Phong model
 * is the one that shaders share.
 *
 * width, height  of a brick with its mortar, in s and t
 * mortar         width of the mortar
 * brickcolor, mortarcolor
 * Ka, Kd, Ks     how much ambient light, light sources and highlights count
 * specularcolor, size   color and sharpness of highlights
 */
surface simple_brick(uniform unsigned fixed<16,14> width = 0.25, height = 0.1, mortar = 0.012;
                     uniform color brickcolor = color (0.52, 0.17, 0.11);
                     uniform color mortarcolor = color (0.62, 0.58, 0.52);
                     uniform float Ka = 1, Kd = 0.9, Ks = 0; uniform color specularcolor = 1; uniform float size = 20;) {
    unsigned fixed<16,12> ss = s, tt = t;
    /* figure out which row of bricks this is (row is an 8-bit integer) */
    fixed<8,0> row = tt / height;
    /* offset even rows by half a row */
    if (row % 2 == 0)
        ss += width / 2;
    /* wrap texture coordinates to get brick coordinates */
    ss = ss % width;
    tt = tt % height;
    /* pick a color for the brick surface */
    color surface_color = brickcolor;
    if (ss < mortar || tt < mortar)
        surface_color = mortarcolor;
    Ci = shared_phong(surface_color, Ka, Kd, Ks, specularcolor, size);
    Oi = 1;
}
