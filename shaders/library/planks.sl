/* SPDX-License-Identifier: Apache-2.0
 *
 * planks: a floor of wooden planks with end joints offset from row to row, dark gaps, growth rings and fibres along
 * the plank that differ from plank to plank, varnished. Planks run along s and lie side by side in t. The grain is
 * measured in plank widths, so that the floor looks the same in inches, feet or metres.
 *
 * width, planklength     of a plank, in t and s
 * gap                    between planks
 * edge                   over which width a gap is softened
 * lightwood, darkwood    between and on the growth rings
 * ringscale              rings across a plank
 * fibre                  strength of the fibres
 * variation              how much planks differ
 * Ka, Kd, Ks, roughness  reflection of the varnished wood
 * varnish, varnishcolor  what the varnish mirrors when one looks along it, and its color
 */
surface planks(float width = 0.1; float planklength = 0.6; float gap = 0.003; float edge = 0.003;
               color lightwood = color (0.62, 0.40, 0.20); color darkwood = color (0.34, 0.18, 0.07);
               float ringscale = 3; float fibre = 0.35; float variation = 0.3;
               float Ka = 1; float Kd = 0.8; float Ks = 0; float roughness = 0.08;
               float varnish = 0; color varnishcolor = color (0.5, 0.5, 0.5);) {
    /* which plank, and where on it */
    float across = t / width;
    float row = floor(across);
    float shifted = s + planklength * noise(row * 3.37 + 0.5);
    float column = floor(shifted / planklength);
    float x = shifted - column * planklength;
    float y = (across - row) * width;
    /* Each plank is cut from another place of the tree. */
    float id = noise(row * 7.91 + 0.5, column * 5.13 + 0.5);
    float offset = id * 40;
    float along = s / width + offset;
    /* Rings rise slowly and end at once, as wood grows from spring to winter. */
    float bend = noise(along * 0.11, across * 0.9 + offset);
    float ring = mod(ringscale * (across + 2.2 * bend) + offset, 1);
    ring = smoothstep(0, 0.7, ring) * (1 - smoothstep(0.78, 1, ring));
    float fibres = noise(along * 0.7, across * 19 + offset) - 0.5;
    color wood = mix(lightwood, darkwood, clamp(0.6 * ring + 0.5 * fibres + 1.5 * variation * (id - 0.4), 0, 1));
    wood *= (1 + fibre * fibres) * (1 + 2 * variation * (id - 0.5));

    float half = gap / 2;
    float joint = min(min(y, width - y), min(x, planklength - x));
    float inside = smoothstep(half - edge, half + edge, joint);
    wood *= 0.2 + 0.8 * inside;

    normal Nf = faceforward(normalize(N), I);
    vector V = -normalize(I);
    color body = Ka * ambient();
    color shine = 0;
    illuminance (P) {
        vector Ln = normalize(L);
        float facing = max(0, Nf . Ln);
        body += Kd * facing * Cl;
        if (Ks > 0)
            shine += pow(max(0, Nf . normalize(Ln + V)), 1 / roughness) * smoothstep(0, 0.05, facing) * Cl;
    }
    Ci = wood * body;
    if (varnish > 0) {
        /* Schlick's approximation of how much more a surface mirrors the flatter one looks along it */
        float grazing = 1 - clamp(Nf . V, 0, 1);
        float squared = grazing * grazing;
        float mirror = varnish * inside * squared * squared * grazing;
        Ci = Ci * (1 - mirror) + mirror * varnishcolor;
    }
    if (Ks > 0)
        Ci += inside * Ks * shine;
    Oi = 1;
}
