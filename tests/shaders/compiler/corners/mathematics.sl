float near(float a, b) { return abs(a - b) < 0.0001 * (1 + abs(b)); }
surface mathematics() {
    float ok = near(radians(180), PI) * near(degrees(PI), 180) * near(sin(PI / 6), .5) * near(cos(PI / 3), .5)
        * near(tan(PI / 4), 1) * near(asin(1), PI / 2) * near(acos(0), PI / 2) * near(atan(1), PI / 4)
        * near(atan(-1, -1), -3 * PI / 4) * near(pow(2, 10), 1024) * near(exp(1), 2.718281828)
        * near(sqrt(2) * inversesqrt(2), 1) * near(log(8, 2), 3) * near(log(exp(2)), 2);
    ok *= mod(-1, 3) == 2 && abs(-2) == 2 && sign(-5) == -1 && sign(0) == 0 && floor(-.5) == -1
        && ceil(.5) == 1 && round(1.5) == 2 && step(1, 1) == 1 && near(smoothstep(0, 2, 1), .5) == 1;
    ok *= min(4, 2, 3) == 2 && max(1, 5, 3, 4) == 5 && clamp(9, 0, 4) == 4 && mix(2, 4, .25) == 2.5;
    ok *= max(color (1, 5, 2), color (3, 1, 4)) == color (3, 5, 4) && mix(color 0, color 1, .5) == color .5
        && clamp(point (9, -9, 1), point 0, point 4) == point (4, 0, 1);
    Ci = color (0, ok, 0);
}
