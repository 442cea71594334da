/* SPDX-License-Identifier: Apache-2.0
 *
 * bowling_ball: swirled resin with three finger holes under a polish that mirrors a bright window and the room.
 * The ball is around the origin of shader space, its holes about the z axis.
 *
 * radius                 of the ball
 * darkcolor, brightcolor, veincolor  of the resin
 * swirls                 how many swirls there are
 * holesize               radius of a finger hole, in radii of the ball
 * Ka, Kd                 how much ambient light and light sources count
 * mirror                 how much the polish mirrors
 * floorcolor, skycolor   of the room that is mirrored, below and above
 * windowcolor, windowx, windowy, windowwidth, windowheight  as in bowling_pin
 */
surface bowling_ball(float radius = 1;
                     color darkcolor = color (0.008, 0.012, 0.06); color brightcolor = color (0.012, 0.09, 0.36);
                     color veincolor = color (0.10, 0.36, 0.62); float swirls = 1.6; float holesize = 0.115;
                     float Ka = 1; float Kd = 0.8; float mirror = 1;
                     color floorcolor = color (0.30, 0.18, 0.09); color skycolor = color (0.20, 0.22, 0.26);
                     color windowcolor = color (4, 3.6, 3); float windowx = 0.25; float windowy = 0.75;
                     float windowwidth = 0.5; float windowheight = 0.7;) {
    /* Noise that is looked up where noise says swirls. */
    point Q = transform("shader", P) / radius;
    point S = Q * swirls;
    float stir = noise(S);
    float fold = noise(S * 1.7 + 4 * vector (stir, 0.5 - stir, stir));
    float thread = noise(S * 3 + 6 * vector (fold, stir, 1 - fold));
    color resin = mix(darkcolor, brightcolor, smoothstep(0.35, 0.65, fold));
    resin = mix(resin, veincolor, 0.5 * (1 - smoothstep(0.0, 0.07, abs(thread - 0.5))));

    /* Two fingers and a thumb: the distance to the nearest hole. */
    float d1 = distance(Q, point (-0.16, 0.20, 0.966));
    float d2 = distance(Q, point (0.16, 0.20, 0.966));
    float d3 = distance(Q, point (0, -0.34, 0.940));
    float hole = min(min(d1, d2), d3 - 0.02) - holesize;
    float solid = smoothstep(-0.012, 0.004, hole);

    normal Nf = faceforward(normalize(N), I);
    vector V = -normalize(I);
    color body = resin * solid * (Ka * ambient() + Kd * diffuse(Nf));

    vector R = vtransform("world", 2 * (Nf . V) * Nf - V);
    float grazing = 1 - clamp(Nf . V, 0, 1);
    float squared = grazing * grazing;
    float share = mirror * solid * (0.05 + 0.95 * squared * squared * grazing);
    float back = max(-zcomp(R), 0.01);
    float wx = abs(xcomp(R) / back - windowx) / windowwidth;
    float wy = abs(ycomp(R) / back - windowy) / windowheight;
    /* Where R points away from the window, wx and wy mean nothing. */
    float pane = step(0, -zcomp(R)) * (1 - smoothstep(0.46, 0.54, wx)) * (1 - smoothstep(0.46, 0.54, wy)) *
                 smoothstep(0.02, 0.07, wx) * smoothstep(0.01, 0.05, wy);
    color room = mix(floorcolor, skycolor, smoothstep(-0.25, 0.25, ycomp(R)));
    Ci = body * (1 - share) + share * mix(room, windowcolor, pane);
    Oi = 1;
}
