#ifndef HELPERS_H
#define HELPERS_H
float half(float x) { return x / 2; }
float near(float a, b) { return abs(a - b) < 0.0001; }
#endif
