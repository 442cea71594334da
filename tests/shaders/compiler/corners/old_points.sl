/* before vectors and normals there were points only */
point flip(point n; point i) { point r; r = faceforward(normalize(n), i); return r; }
surface old_points(float Ks = .5, Kd = .5, roughness = .1; color specularcolor = 1;)
{
    point Nf, V, R;
    Nf = flip(N, I);
    V = -normalize(I);
    R = 2 * Nf * (Nf . V) - V;
    Oi = Os;
    Ci = Os * (color (0, 1, 0) + Kd * diffuse(Nf) + specularcolor * Ks * specular(Nf, V, roughness));
    if (length(R - V) > 0.0001) Ci = 1;
}
