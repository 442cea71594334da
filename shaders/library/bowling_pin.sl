/* SPDX-License-Identifier: Apache-2.0
 *
 * bowling_pin: white lacquer with two red stripes around the neck, scuffs where the ball hits, and a soft shine.
 * The pin stands along t, from 0 at the foot to 1 at the head.
 *
 * pincolor, stripecolor
 * stripe1, stripe2  middle of the stripes, in t
 * stripewidth       of each
 * edge              over which width an edge is softened
 * scuffs            how scuffed the belly is
 * scuffcolor
 * Ka, Kd, Ks, roughness  reflection
 */
surface bowling_pin(color pincolor = color (0.93, 0.91, 0.86); color stripecolor = color (0.72, 0.05, 0.06);
                    float stripe1 = 0.68; float stripe2 = 0.75; float stripewidth = 0.03; float edge = 0.003;
                    float scuffs = 0.6; color scuffcolor = color (0.28, 0.25, 0.22);
                    float Ka = 1; float Kd = 0.8; float Ks = 0.5; float roughness = 0.06;) {
    float half = stripewidth / 2;
    float d1 = abs(t - stripe1);
    float d2 = abs(t - stripe2);
    float stripe = 1 - smoothstep(half - edge, half + edge, min(d1, d2));
    color base = mix(pincolor, stripecolor, stripe);

    /* long scratches around the belly, and rubbed patches */
    float belly = smoothstep(0.1, 0.25, t) * (1 - smoothstep(0.4, 0.6, t));
    float patch = smoothstep(0.55, 0.75, noise(s * 6, t * 5));
    float scratch = smoothstep(0.62, 0.7, noise(s * 10, t * 160)) * smoothstep(0.5, 0.6, noise(s * 9 + 20, t * 9));
    float worn = scuffs * belly * clamp(0.5 * patch * noise(s * 80, t * 80) + scratch, 0, 1);
    base = mix(base, scuffcolor, worn);

    normal Nf = faceforward(normalize(N), I);
    vector V = -normalize(I);
    Ci = base * (Ka * ambient() + Kd * diffuse(Nf)) + Ks * (1 - 0.8 * worn) * specular(Nf, V, roughness);
    Oi = 1;
}
