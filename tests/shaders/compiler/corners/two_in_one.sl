// warning: more than one shader in this file: two_in_one is used
surface another() { Ci = 1; }
surface two_in_one() { Ci = color (0, 1, 0); }
