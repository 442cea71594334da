surface
declarations(float a = 1, b = 2, c; uniform float d = 4; varying float e = 5;
             color tint = color (0, 1, 0); point where = point "shader" (1, 2, 3); string name = "";)
{
    float x = a, y, z = x + b;
    uniform float i;
    varying color r = 0;
    y = 3;
    i = d;
    if (x + y + z + c + i + e == 16 && name == "")
        r = tint;
    Ci = r;
}
