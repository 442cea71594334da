// warning: attribute("ShadingRate") is 0: it is not known here
surface scene_questions() {
    float size[3], rate = 7, version[4];
    uniform string who = "";
    uniform float known = rendererinfo("renderer", who) * rendererinfo("version", version);
    uniform float formatted = option("Format", size);
    float asked = attribute("ShadingRate", rate);
    Ci = color (0, known == 1 && who == "sortlast" && formatted == 0 && asked == 0 && rate == 7, 0);
}
