// warning: printf is ignored
surface print() { printf("P = %p, s = %f\n", P, s); Ci = color (0, 1, 0); }
