surface broken(float a = ;) { Ci = (1, 2; if } { "never closed
 /* 