/* SPDX-License-Identifier: Apache-2.0
 *
 * checker: square tiles of two colors with grout between them.
 *
 * size         tiles per unit of s and t
 * first, second, groutcolor
 * grout        width of the grout in tiles
 * edge         over which width an edge is softened, in tiles
 * Ka, Kd, Ks, roughness  reflection of the glaze
 */
surface checker(float size = 8; color first = color (0.85, 0.83, 0.78); color second = color (0.12, 0.16, 0.2);
                color groutcolor = color (0.4, 0.39, 0.37); float grout = 0.04; float edge = 0.015;
                float Ka = 1; float Kd = 0.8; float Ks = 0.25; float roughness = 0.08;) {
    float x = s * size;
    float y = t * size;
    float parity = mod(floor(x) + floor(y), 2);
    float fx = abs(mod(x, 1) - 0.5);
    float fy = abs(mod(y, 1) - 0.5);
    float limit = 0.5 - grout / 2;
    float tile = 1 - smoothstep(limit - edge, limit + edge, max(fx, fy));
    color glaze = mix(first, second, parity);
    normal Nf = faceforward(normalize(N), I);
    vector V = -normalize(I);
    Ci = mix(groutcolor, glaze, tile) * (Ka * ambient() + Kd * diffuse(Nf)) +
         Ks * tile * specular(Nf, V, roughness);
    Oi = 1;
}
