/* SPDX-License-Identifier: Apache-2.0
 *
 * bowling_pin: white lacquer with two red stripes around the neck and scuffs where the ball hits. The lacquer mirrors
 * a bright window and, dimly, the room.
 *
 * The pin stands upright on the plane y = 0 of shader space. Height and scuffs come from the position there, which
 * the machine rebuilds from depth: of all that is interpolated only the normal travels. All pins that stand on
 * one floor can share one instance of the shader, and yet no two are scuffed alike.
 *
 * height                 of the pin
 * pincolor, stripecolor
 * stripe1, stripe2       middle of the stripes, from 0 at the foot to 1 at the head
 * stripewidth            of each
 * edge                   over which width an edge is softened
 * scuffs, scuffcolor     how scuffed the belly is
 * Ka, Kd                 how much ambient light and light sources count
 * mirror                 how much the lacquer mirrors
 * floorcolor, skycolor   of the room that is mirrored, below and above
 * windowcolor            of the window
 * windowx, windowy       where the window is: towards (windowx, windowy, -1) of world space, far away
 * windowwidth, windowheight  its size, in the same measure
 */
surface bowling_pin(float height = 1;
                    color pincolor = color (0.88, 0.85, 0.78); color stripecolor = color (0.60, 0.02, 0.03);
                    float stripe1 = 0.625; float stripe2 = 0.72; float stripewidth = 0.04; float edge = 0.002;
                    float scuffs = 0.5; color scuffcolor = color (0.22, 0.19, 0.17);
                    float Ka = 1; float Kd = 0.8; float mirror = 0.9;
                    color floorcolor = color (0.30, 0.18, 0.09); color skycolor = color (0.20, 0.22, 0.26);
                    color windowcolor = color (4, 3.6, 3); float windowx = 0.25; float windowy = 0.75;
                    float windowwidth = 0.5; float windowheight = 0.7;) {
    point Q = transform("shader", P) / height;
    float up = ycomp(Q);
    float half = stripewidth / 2;
    float stripe = 1 - smoothstep(half - edge, half + edge, min(abs(up - stripe1), abs(up - stripe2)));
    color base = mix(pincolor, stripecolor, stripe);

    /* rubbed patches around the belly, broken up by fine scratches that run around the pin */
    float belly = smoothstep(0.05, 0.2, up) * (1 - smoothstep(0.38, 0.5, up));
    float patch = smoothstep(0.5, 0.68, noise(Q * 7));
    float scratch = smoothstep(0.5, 0.75, noise(point (xcomp(Q) * 40, up * 130, zcomp(Q) * 40)));
    float worn = scuffs * belly * patch * scratch;
    base = mix(base, scuffcolor, worn);

    normal Nf = faceforward(normalize(N), I);
    vector V = -normalize(I);
    color body = base * (Ka * ambient() + Kd * diffuse(Nf));

    /* what the lacquer mirrors: Schlick's approximation, and a window with four panes in a two-coloured room */
    vector R = vtransform("world", 2 * (Nf . V) * Nf - V);
    float grazing = 1 - clamp(Nf . V, 0, 1);
    float squared = grazing * grazing;
    float share = mirror * (1 - worn) * (0.05 + 0.95 * squared * squared * grazing);
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
