light simple_distant(float intensity = 1; color lightcolor = color (0, 1, 0); point from = point "shader" (0, 0, 0); point to = point "shader" (0, 0, 1);) {
    solar (to - from, 0.0) Cl = intensity * lightcolor;
}
