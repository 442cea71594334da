// warning: solar without an axis shines from everywhere: its light is ambient
light sky(string envmap = "";) { solar () { Cl = color (0, 1, 0); if (envmap != "") Cl = 1; } }
