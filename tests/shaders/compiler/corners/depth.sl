surface depth_of_point() { float d = depth(P); Ci = color (0, 1 + 0 * min(d, 0), 0); }
