surface plain_constant() { Oi = Os; Ci = Os * Cs * color (0, 1, 0); }
