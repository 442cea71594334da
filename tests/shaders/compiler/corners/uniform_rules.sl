surface uniform_rules(uniform float count = 4; float scale = 2;) {
    uniform float i, total = 0;
    uniform color u = 0;
    for (i = 0; i < count; i += 1) { total += i; if (i > 2) u = color (0, 1, 0); }
    float mixed = total;
    if (s > 3) mixed = total + 0;
    Ci = u * (mixed == 6) * (scale == 2);
}
