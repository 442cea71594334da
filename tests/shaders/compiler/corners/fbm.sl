// warning: uniform 'amp' is assigned where samples go different ways, and so varies
// warning: uniform 'i' is assigned where samples go different ways, and so varies
float fBm(point p; float filtwidth; uniform float maxoctaves, lacunarity, gain) {
    uniform float i;
    uniform float amp = 1;
    varying float sum = 0, fw = filtwidth;
    varying point pp = p;
    for (i = 0; i < maxoctaves && fw < 10; i += 1) {
        sum += amp * (2 * float noise(pp) - 1) * (1 - smoothstep(0.2, 0.6, fw));
        amp *= gain; pp *= lacunarity; fw *= lacunarity;
    }
    return sum;
}
surface fbm() {
    point PP = transform("shader", P);
    float dP = sqrt(area(PP)), turb = fBm(PP, dP, 5, 2, 0.5);
    Ci = color (0, abs(turb) <= 2, 0);
}
