surface strings(string base = "map"; string channels[3] = {"r", "g", "b"}; uniform float frame = 12;) {
    string name = concat(base, "_", channels[1]);
    string numbered = format("%s.%04d" ".tx", name, frame);
    string other = frame > 10 ? "late" : "early";
    uniform float ok = 0;
    if (numbered == "map_g.0012.tx" && other != "early" && match("g\\.[0-9]+", numbered) == 1)
        ok = 1;
    Ci = color (0, ok, 0);
}
