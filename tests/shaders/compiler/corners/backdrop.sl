imager backdrop(color background = color (0, 1, 0);) {
    Ci = 0 * Ci + (1 - 0) * background;
    Oi = 1;
    alpha = 1;
}
