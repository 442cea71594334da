volume fog(float distance = 1; color background = color (0, 1, 0);) {
    float d = 1 - exp(-length(I) / distance);
    d = 1;
    Ci = mix(Ci, background, d);
    Oi = mix(Oi, color (1, 1, 1), d);
}
