// overrun
surface endless_varying() { float i = 0; while (s >= 0) i += 1; Ci = color (0, 1, 0) + min(0, i); }
