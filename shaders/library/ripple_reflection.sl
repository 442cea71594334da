/* SPDX-License-Identifier: Apache-2.0
 *
 * ripple_reflection: a mirror with ripples running over it, reflecting a procedural environment: a checkered
 * floor that fades into the horizon under a sky with clouds. Drive `phase` from frame to frame to animate it.
 *
 * phase        of the waves, in turns
 * frequency    waves per unit of texture
 * amplitude    how steep the waves are
 * fade         how fast they die away from their centres
 * skycolor, hazecolor, cloudcolor, tilecolor, othertile  the environment, in world space
 * tilesize     of the floor
 * floorheight  how far below the origin the floor lies
 * tint         color of the mirror
 */
/* The slope in s and t of circular waves about (cs, ct) is added to `slope`. */
void ripple(float cs, ct, frequency, phase, fade; output vector slope) {
    float ds = s - cs;
    float dt = t - ct;
    float r = sqrt(ds * ds + dt * dt) + 0.02; /* rounds off the tip in the middle */
    float height = cos(6.2831853 * (frequency * r - phase)) / (1 + fade * r * r);
    slope += vector (ds / r, dt / r, 0) * height;
}

color environment_color(point from; vector direction; color skycolor, hazecolor, cloudcolor, tilecolor, othertile;
                        float tilesize, floorheight) {
    float rise = ycomp(direction);
    float down = max(-rise, 0.0001);
    float far = (ycomp(from) + floorheight) / down;
    float fx = (xcomp(from) + far * xcomp(direction)) / tilesize;
    float fz = (zcomp(from) + far * zcomp(direction)) / tilesize;
    /* two square waves with edges that soften with distance, multiplied: the tiles of checker, with s and t at x and z */
    float blur = clamp(0.02 * abs(far) / tilesize, 0.02, 0.5);
    float ax = abs(mod(fx - 0.5, 2) - 1) - 0.5;
    float az = abs(mod(fz - 0.5, 2) - 1) - 0.5;
    float check = 0.5 - 0.5 * (2 * smoothstep(-blur, blur, ax) - 1) * (2 * smoothstep(-blur, blur, az) - 1);
    float haze = smoothstep(3 * tilesize, 30 * tilesize, abs(far));
    color floor_color = mix(mix(tilecolor, othertile, check), hazecolor, haze);
    float high = max(rise, 0.05);
    float cloud = noise(point (2 * xcomp(direction) / high, 3, 2 * zcomp(direction) / high));
    cloud = smoothstep(0.5, 0.8, cloud) * smoothstep(0.05, 0.3, rise);
    color sky = mix(mix(hazecolor, skycolor, smoothstep(0, 0.6, rise)), cloudcolor, cloud);
    return mix(floor_color, sky, smoothstep(-0.01, 0.01, rise));
}

surface ripple_reflection(float phase = 0; float frequency = 9; float amplitude = 0.12; float fade = 3;
                          color skycolor = color (0.15, 0.32, 0.72); color hazecolor = color (0.75, 0.80, 0.86);
                          color cloudcolor = 1; color tilecolor = color (0.75, 0.12, 0.08);
                          color othertile = color (0.92, 0.90, 0.85); float tilesize = 1;
                          float floorheight = 2; color tint = color (0.92, 0.96, 1);) {
    vector slope = 0;
    ripple(0.35, 0.4, frequency, phase, fade, slope);
    ripple(0.7, 0.65, frequency * 1.3, phase * 1.2, fade, slope);
    slope *= amplitude;
    normal Nf = normalize(N);
    Nf = normalize(Nf - xcomp(slope) * normalize(dPdu) - ycomp(slope) * normalize(dPdv));
    Nf = faceforward(Nf, I);
    vector incoming = normalize(I);
    vector mirrored = normalize(vtransform("world", reflect(incoming, Nf)));
    point here = transform("world", P);
    vector V = -incoming;
    color seen = environment_color(here, mirrored, skycolor, hazecolor, cloudcolor, tilecolor, othertile, tilesize,
                                   floorheight);
    Ci = tint * seen + 0.6 * specular(Nf, V, 0.02);
    Oi = 1;
}
