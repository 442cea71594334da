surface runtime_spaces(string from = "rgb"; string to = "hsv"; string odd = "none";) {
    color c = ctransform(from, to, color (0, 1, 0)), back = ctransform(to, "rgb", c), same = ctransform(odd, c);
    Ci = back;
    if (abs(comp(c, 0) - 1 / 3) > .001 || same != c) Ci = 1;
}
