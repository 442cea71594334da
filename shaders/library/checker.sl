/* SPDX-License-Identifier: Apache-2.0
 *
 * checker: square tiles of two colors with grout between them.
 *
 * size         tiles per unit of s and t
 * first, second, groutcolor
 * grout        width of the grout in tiles
 * edge         over which width an edge is softened, in tiles
 * fade         how far from the eye tiles have faded into their mean color, for floors to the horizon; 0: nowhere
 * Ka, Kd, Ks, roughness  reflection of the glaze
 */
surface checker(float size = 8; color first = color (0.85, 0.83, 0.78); color second = color (0.12, 0.16, 0.2);
                color groutcolor = color (0.4, 0.39, 0.37); float grout = 0.04; float edge = 0.015; float fade = 0;
                float Ka = 1; float Kd = 0.8; float Ks = 0.25; float roughness = 0.08;) {
    float x = s * size;
    float y = t * size;
    float near = fade > 0 ? 1 - smoothstep(fade / 3, fade, length(I)) : 1;
    float parity = 0.5 + (mod(floor(x) + floor(y), 2) - 0.5) * near;
    float fx = abs(mod(x, 1) - 0.5);
    float fy = abs(mod(y, 1) - 0.5);
    float limit = 0.5 - grout / 2;
    float tile = 1 - near * smoothstep(limit - edge, limit + edge, max(fx, fy));
    color glaze = mix(first, second, parity);
    normal Nf = faceforward(normalize(N), I);
    vector V = -normalize(I);
    Ci = mix(groutcolor, glaze, tile) * (Ka * ambient() + Kd * diffuse(Nf)) +
         Ks * tile * specular(Nf, V, roughness);
    Oi = 1;
}
