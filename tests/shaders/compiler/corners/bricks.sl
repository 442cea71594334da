#define BMWIDTH (brickwidth + mortar)
#define BMHEIGHT (brickheight + mortar)
#define MWF (mortar * 0.5 / BMWIDTH)
#define boxstep(a, b, x) clamp(((x) - (a)) / ((b) - (a)), 0, 1)
surface bricks(uniform float brickwidth = .25, brickheight = .08, mortar = .01; uniform color brick = color "rgb" (.6, .1, .1);) {
    float ss = s / BMWIDTH, tt = t / BMHEIGHT, sbrick, tbrick, w;
    if (mod(tt * 0.5, 1) > 0.5) ss += 0.5;
    sbrick = floor(ss); tbrick = floor(tt);
    ss -= sbrick; tt -= tbrick;
    w = boxstep(MWF - .01, MWF, ss) - boxstep(1 - MWF - .01, 1 - MWF, ss);
    Ci = color (0, w >= 0 && w <= 1 && ss >= 0 && ss < 1, 0) + 0 * brick;
}
