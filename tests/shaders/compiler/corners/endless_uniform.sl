// overrun
surface endless_uniform() { uniform float i = 0; while (1) i += 1; Ci = color (0, 1, 0) + min(0, i); }
