surface wood_grain(float ringscale = 10; color lightwood = color (0.3, 0.12, 0.03); color darkwood = color (0.05, 0.01, 0.005);) {
    point PP; float y, z, r;
    PP = transform("shader", P);
    PP += noise(PP);
    y = ycomp(PP); z = zcomp(PP);
    r = sqrt(y * y + z * z);
    r *= ringscale;
    r += abs(noise(r));
    r -= floor(r);
    r = smoothstep(0, 0.8, r) - smoothstep(0.83, 1.0, r);
    color c = mix(lightwood, darkwood, r);
    Ci = color (0, r >= -0.001 && r <= 1.001 && comp(c, 0) > 0.04, 0);
}
