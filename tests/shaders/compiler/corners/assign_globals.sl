// warning: 'Kd' is a parameter of the shader and not declared output: only this shader sees the change
surface assign_globals(float Kd = 2;) {
    s *= 2; t = s; u += v; Cs = color (0, 1, 0); Os = 1; N = -N; P += N; Kd = Kd / 2;
    Ci = Cs * Os * Kd * (t == s);
    Oi = Os;
}
