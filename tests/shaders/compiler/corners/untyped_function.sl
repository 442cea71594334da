twice(float x) { return 2 * x; }
float half(float x) { return x / 2; }
surface untyped_function() { Ci = color (0, twice(half(1)), 0); }
