light spot(float intensity = 1; color lightcolor = color (0, 1, 0); point from = (0, 0, -1e6); point to = (0, 0, 0);
           float coneangle = radians(30), conedeltaangle = radians(5), beamdistribution = 2;) {
    float atten, cosangle;
    uniform vector A = (to - from) / length(to - from);
    uniform float cosoutside = cos(coneangle), cosinside = cos(coneangle - conedeltaangle);
    illuminate (from, A, coneangle) {
        cosangle = (L . A) / length(L);
        atten = pow(cosangle, beamdistribution) / 1;
        atten *= smoothstep(cosoutside, cosinside, cosangle);
        Cl = round(atten) * intensity * lightcolor;
    }
}
