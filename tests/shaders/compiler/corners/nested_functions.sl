surface nested_functions(float Ka = 3;) {
    float total = 0;
    void add(float x) { extern float total; extern point P; total += x * Ka; }
    float doubled() { float inner(float y) { return 2 * y; } return inner(total); }
    float i;
    for (i = 0; i < 4; i += 1) add(i);
    Ci = color (0, doubled() == 36, 0);
}
