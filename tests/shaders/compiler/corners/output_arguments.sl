void split(float x; output float whole; output varying float part;) { whole = floor(x); part = x - whole; }
void bump(output color c) { c += color (0, 1, 0); }
surface output_arguments() {
    float w, parts[2] = {7, 8};
    color list[2] = {0, 0};
    uniform float i = 1;
    split(s + 0.25, w, parts[i]);
    bump(list[0]);
    Ci = w == s && parts[1] == 0.25 && parts[0] == 7 ? list[0] : 1;
}
