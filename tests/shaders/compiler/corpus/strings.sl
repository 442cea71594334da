light strings(string kind = "spot"; float angle = radians(30); point from = (0, 1, 0);) {
    string other = kind == "spot" ? "world" : "shader";
    if (kind == "spot") illuminate (from, vector (0, 0, 1), angle) Cl = noise(transform(other, Ps));
    else if (kind != "sun") solar (vector "world" (0, 0, 1), 0) Cl = 1;
    else Cl = 0.1;
}
