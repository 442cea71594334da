/* SPDX-License-Identifier: Apache-2.0
 *
 * mandelbrot_fixed: the Mandelbrot set in fixed-point, after figure 4 b of Olano and Lastra, "A Shading Language on
 * Graphics Hardware: The PixelFlow Shading System" (1998). Numbers from -8 to 8 with 44 bits after the point: six bytes,
 * of which none is wasted on an exponent.
 *
 * centerx, centery  middle of the view; finex, finey are added to it, for digits that one float does not hold
 * view              width of the view
 * turns             iterations at most
 */
surface mandelbrot_fixed(uniform float centerx = -0.75, centery = 0, finex = 0, finey = 0, view = 3, turns = 96;) {
    uniform fixed<48,44> middle_x = centerx, middle_y = centery;
    uniform fixed<48,44> rest_x = finex, rest_y = finey;
    fixed<48,44> offset_x = (s - 0.5) * view, offset_y = (0.5 - t) * view;
    fixed<48,44> cx = middle_x + rest_x + offset_x;
    fixed<48,44> cy = middle_y + rest_y + offset_y;
    fixed<48,44> x = 0, y = 0;
    float count = 0, i;
    for (i = 0; i < turns; i += 1) {
        unsigned fixed<50,44> x2 = x * x;
        unsigned fixed<50,44> y2 = y * y;
        if (x2 + y2 > 4)
            break;
        y = 2 * x * y + cy;
        x = x2 - y2 + cx;
        count += 1;
    }
    float shade = mod(count, 24) / 24;
    Ci = count >= turns ? color (0, 0, 0)
                        : spline(shade, color (0.05, 0.05, 0.3), color (0.05, 0.05, 0.3), color (0.2, 0.5, 0.9),
                                 color (1, 0.95, 0.7), color (0.8, 0.35, 0.05), color (0.05, 0.05, 0.3),
                                 color (0.05, 0.05, 0.3));
}
