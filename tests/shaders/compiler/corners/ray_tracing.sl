// error: occlusion() is not supported: it needs ray tracing
surface ray_tracing() { Ci = 1 - occlusion(P, N, 64, "maxdist", 10); }
