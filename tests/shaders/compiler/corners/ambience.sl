light ambience(float intensity = 1; color lightcolor = color (0, 1, 0);) { Cl = intensity * lightcolor; }
