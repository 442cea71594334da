/* SPDX-License-Identifier: Apache-2.0
 *
 * window_light: light that shines through a paned window. The window is in the plane z = `windowdistance` of shader
 * space, seen from the light at the origin, its middle on the z axis.
 *
 * intensity, lightcolor  without falloff, as from far behind the window
 * width, height          of the window
 * panesx, panesy         how many panes
 * frame                  width of the bars between panes and around
 * blur                   softness of the shadows of the bars
 * windowdistance         of the window from the light
 * outside                how much light passes beside the window
 */
/* 1 inside a pane, 0 on the bars and outside, for one axis; x runs from 0 to 1 over the window. */
float pane(float x; float panes; float bar; float blur) {
    float inside = smoothstep(0, blur, x) * (1 - smoothstep(1 - blur, 1, x));
    float f = abs(mod(x * panes, 1) - 0.5);
    float limit = 0.5 - bar * panes / 2;
    float soft = blur * panes;
    return inside * (1 - smoothstep(limit - soft, limit + soft, f));
}

light window_light(float intensity = 1; color lightcolor = color (1, 0.95, 0.85);
                   float width = 1; float height = 1.4; float panesx = 2; float panesy = 3;
                   float frame = 0.06; float blur = 0.015; float windowdistance = 2; float outside = 0;) {
    illuminate (point "shader" (0, 0, 0)) {
        point Q = transform("shader", Ps);
        float z = zcomp(Q);
        float scale = windowdistance / max(z, 0.0001);
        float x = xcomp(Q) * scale / width + 0.5;
        float y = ycomp(Q) * scale / height + 0.5;
        float through = pane(x, panesx, frame / width, blur) * pane(y, panesy, frame / height, blur);
        through = z > windowdistance ? through : 0;
        Cl = intensity * mix(outside, 1, through) * lightcolor;
    }
}
