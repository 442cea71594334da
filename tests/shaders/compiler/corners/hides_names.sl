// warning: parameter 's' hides the predefined variable of this name
surface hides_names(float s = 1; float light = 0, volume = 2;) {
    float noise = 3, t = volume;
    { float noise = 4; t += noise; }
    Ci = color (0, s * (t + noise == 9), 0) + light;
}
