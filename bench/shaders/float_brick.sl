/* SPDX-License-Identifier: Apache-2.0
 *
 * float_brick: simple_brick with floats for its fixed-point numbers, to measure one against the other. */
surface float_brick(uniform float width = 0.25, height = 0.1, mortar = 0.012;
                    uniform color brickcolor = color (0.52, 0.17, 0.11);
                    uniform color mortarcolor = color (0.62, 0.58, 0.52);
                    uniform float Ka = 1, Kd = 0.9, Ks = 0; uniform color specularcolor = 1;
                    uniform float size = 20;) {
    float ss = s, tt = t;
    float row = floor(tt / height);
    if (row % 2 == 0)
        ss += width / 2;
    ss = ss % width;
    tt = tt % height;
    color surface_color = brickcolor;
    if (ss < mortar || tt < mortar)
        surface_color = mortarcolor;
    Ci = shared_phong(surface_color, Ka, Kd, Ks, specularcolor, size);
    Oi = 1;
}
