/* SPDX-License-Identifier: Apache-2.0
 *
 * planks: a floor of wooden planks with end joints offset from row to row, dark gaps, fibres along the plank and
 * rings that differ from plank to plank, varnished.
 *
 * width, planklength  of a plank, in t and s
 * gap            between planks
 * lightwood, darkwood
 * ringscale      rings across a plank
 * variation      how much planks differ
 * Ka, Kd, Ks, roughness  reflection of the varnished wood
 */
surface planks(float width = 0.1; float planklength = 0.6; float gap = 0.003;
               color lightwood = color (0.62, 0.40, 0.20); color darkwood = color (0.34, 0.18, 0.07);
               float ringscale = 5; float variation = 0.3;
               float Ka = 1; float Kd = 0.8; float Ks = 0.25; float roughness = 0.08;) {
    float row = floor(t / width);
    float shift = planklength * noise(row * 3.37 + 0.5);
    float column = floor((s + shift) / planklength);
    float x = s + shift - column * planklength;
    float y = t - row * width;
    /* each plank is cut from another place of the tree */
    float id = noise(row * 7.91 + 0.5, column * 5.13 + 0.5);
    float offset = id * 40;
    float wave = noise(s * 3 + offset, t * 20 + offset);
    float ring = mod(ringscale * (y / width + 0.35 * wave) + offset, 1);
    ring = smoothstep(0, 0.7, ring) * (1 - smoothstep(0.8, 1, ring));
    float fibre = noise(s * 14 + offset, t * 420);
    color wood = mix(lightwood, darkwood, 0.7 * ring) * (0.85 + 0.3 * fibre);
    wood *= 1 + variation * 2 * (id - 0.5);
    float inside = smoothstep(0, gap, y) * (1 - smoothstep(width - gap, width, y)) *
                   smoothstep(0, gap, x) * (1 - smoothstep(planklength - gap, planklength, x));
    wood *= 0.15 + 0.85 * inside;

    normal Nf = faceforward(normalize(N), I);
    vector V = -normalize(I);
    Ci = wood * (Ka * ambient() + Kd * diffuse(Nf)) + Ks * inside * specular(Nf, V, roughness);
    Oi = 1;
}
