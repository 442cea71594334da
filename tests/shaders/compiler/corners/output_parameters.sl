surface output_parameters(output varying float depth = 0; output varying color layer = 1; varying output point q = 0;) {
    depth = length(I);
    layer = color (0, depth > 0, 0);
    if (s > 2) q = P;
    Ci = layer;
}
