surface show_normals() {
    normal Nn = normalize(ntransform("object", N)), Gn = normalize(Ng);
    color as_color = (color (xcomp(Nn), ycomp(Nn), zcomp(Nn)) + 1) / 2;
    Ci = color (0, comp(as_color, 2) == 0 && zcomp(Gn) == -1, 0);
}
