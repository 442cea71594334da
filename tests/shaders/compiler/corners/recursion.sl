// error: recursion: f calls f; functions are inlined and cannot call themselves
float f(float x) { return x < 1 ? 1 : x * f(x - 1); }
surface recursion() { Ci = f(s); }
