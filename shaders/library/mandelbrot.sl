/* SPDX-License-Identifier: Apache-2.0
 *
 * mandelbrot: the Mandelbrot set in floats, after figure 4 a of Olano and Lastra, "A Shading Language on Graphics
 * Hardware: The PixelFlow Shading System" (1998). Deep down it falls apart into blocks: a float has too few digits
 * between -2 and 2.
 *
 * centerx, centery  middle of the view; finex, finey are added to it, for digits that one float does not hold
 * view              width of the view
 * turns             iterations at most
 */
surface mandelbrot(uniform float centerx = -0.75, centery = 0, finex = 0, finey = 0, view = 3, turns = 96;) {
    float cx = centerx + (finex + (s - 0.5) * view);
    float cy = centery + (finey + (0.5 - t) * view);
    float x = 0, y = 0, count = 0, i;
    for (i = 0; i < turns; i += 1) {
        float x2 = x * x;
        float y2 = y * y;
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
