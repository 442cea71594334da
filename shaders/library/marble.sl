/* SPDX-License-Identifier: Apache-2.0
 *
 * marble: veins where a turbulent sine crosses its peaks.
 *
 * veins      veins per unit length, in shader space
 * octaves    of turbulence
 * strength   how far turbulence pulls the veins
 * pale, dark, tint  colors of stone, vein and the clouds between
 * Ka, Kd, Ks, roughness  reflection of the polished stone
 */
float turbulence(point p; float octaves) {
    float sum = 0;
    float size = 1;
    float i;
    for (i = 0; i < octaves; i += 1) {
        sum += abs(noise(p / size) - 0.5) * 2 * size;
        size *= 0.5;
    }
    return sum;
}

surface marble(float veins = 3; float octaves = 6; float strength = 1.6;
               color pale = color (0.86, 0.84, 0.80); color dark = color (0.17, 0.15, 0.19);
               color tint = color (0.72, 0.66, 0.60);
               float Ka = 1; float Kd = 0.8; float Ks = 0.4; float roughness = 0.06;) {
    point Q = transform("shader", P) * veins;
    float cloud = turbulence(Q, octaves);
    float wave = 0.5 + 0.5 * sin(3.14159265 * (xcomp(Q) + 0.3 * ycomp(Q) + strength * cloud));
    float vein = pow(wave, 6);
    color stone = mix(mix(pale, tint, clamp(cloud, 0, 1)), dark, vein);
    normal Nf = faceforward(normalize(N), I);
    vector V = -normalize(I);
    Ci = stone * (Ka * ambient() + Kd * diffuse(Nf)) + Ks * specular(Nf, V, roughness);
    Oi = 1;
}
