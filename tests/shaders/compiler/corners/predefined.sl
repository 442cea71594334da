surface predefined() {
    float ok = ncomps == 3 && time == 0 && dtime == 0 && PI > 3.14 && E == point "camera" 0 && Ps == P
        && length(dPdtime) == 0 && Oi == 0 && Ci == 0 && length(I) > 0;
    Oi = Os;
    Ci = color (0, ok, 0) * Cs;
}
