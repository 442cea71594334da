// warning: surface("Kd") is 0: there is no such shader here
// warning: displacement("depth") is 0: there is no such shader here
// warning: atmosphere("fog") is 0: there is no such shader here
// warning: incident("eta") is 0: no ray passes through a volume
// warning: opposite("eta") is 0: no ray passes through a volume
surface messages_nowhere() {
    float x = 5, y = surface("Kd", x) + displacement("depth", x) + atmosphere("fog", x) + incident("eta", x) + opposite("eta", x);
    Ci = color (0, x == 5 && y == 0, 0);
}
