light messenger(string __category = "key"; output varying float __nondiffuse = 0; output float __nonspecular = 0;
                output varying color inShadow = 0; string shadowname = "";) {
    illuminate (P + vector (0, 0, -1000)) {
        __nondiffuse = 0.5;
        Cl = color (0, 1, 0);
        if (shadowname != "") inShadow = 1;
    }
}
