// error: an array length is a whole number from 1 to 65536
surface limit_arrays() { float a[1000000]; Ci = a[0]; }
