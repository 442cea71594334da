# SPDX-License-Identifier: Apache-2.0
"""What shaders may ask of a scene, on whole clusters: every scene here is shaded twice, once by the shader under test
and once by a plain one that says what must come out."""

from harness import Folder, main

CAMERA = ('Format 96 64 1\nPixelSamples 1 1\nProjection "perspective" "fov" [50]\nClipping 1 20\n'
          'Declare "km" "float"\nDeclare "k" "float"\nDeclare "scale" "float"\nDeclare "dusty" "color"\n'
          'Declare "where" "string"\nDeclare "level" "float"\n')
WALL = 'Polygon "P" [-9 -9 8  9 -9 8  9 9 12  -9 9 12]\n'
NODES = [(1, 1), (3, 2)]


def small_regions(folder):
    """The machine with regions of another shape: more of their borders, the same quads."""
    import json
    import os
    from harness import SOURCE
    with open(os.path.join(SOURCE, "machines", "pixelflow.json")) as text:
        machine = json.load(text)
    machine["name"] = "small regions"
    machine["parameters"]["region_width"]["value"] = 10
    machine["parameters"]["region_height"]["value"] = 14
    return folder.write("small.json", json.dumps(machine))


def picture(folder, name, scene, *arguments):
    path = folder.write(name + ".rib", scene)
    summary = folder.render(path, "-o", folder.file(name + ".exr"), "--driver", "in-process", *arguments)
    return summary["frames"][0]["image"]


def close(folder, a, b, largest=2e-5):
    code, out, err = folder.run("compare", a, b, "--only", "R,G,B", "--max-error", largest)
    assert code == 0, out + err


def check_same(folder, shaders, scene, expected, largest=2e-5):
    """`scene` equals `expected` up to rounding, itself bit for bit on other clusters and machines, and itself in double
    precision nearly."""
    for name, text in shaders.items():
        folder.write(name + ".sl", text)
    first = picture(folder, "first", scene, "-r", 1, "-s", 1)
    close(folder, picture(folder, "expected", expected, "-r", 1, "-s", 1), first, largest)
    other = picture(folder, "other", scene, "-r", 3, "-s", 2)
    folder.assert_same_picture(first, other)
    small = picture(folder, "small", scene, "-r", 2, "-s", 3, "--machine", small_regions(folder))
    folder.assert_same_picture(first, small)
    precise = picture(folder, "reference", scene, "-r", 1, "-s", 1, "--math", "reference")
    close(folder, first, precise, max(largest, 1e-3))


def world(attributes, geometry=WALL, options="", lights=""):
    return CAMERA + options + "WorldBegin\n" + lights + attributes + geometry + "WorldEnd\n"


def test_derivatives_are_the_same_for_every_cluster_and_region():
    shaders = {
        "slopes": "surface slopes() { normal n = normalize(calculatenormal(P)); float g = Du(3 * u + s); "
                  "Ci = color (abs(zcomp(n)), g, area(P) > 0 ? 1 : 0); }",
        "flat": "surface flat() { normal n = normalize(N); Ci = color (abs(zcomp(n)), 4, 1); }",
    }
    with Folder() as folder:
        # a u that runs from 0 to 1 has small differences: their quotients are good to a few in a thousand
        check_same(folder, shaders, world('Surface "slopes"\n'), world('Surface "flat"\n'), 0.05)


def test_derivatives_at_silhouettes_and_between_instances_do_not_depend_on_the_cluster():
    shaders = {"widths": "surface widths(float k = 1;) { Ci = color (filterwidth(k * s), filterwidth(t), length(Du(P))); }"}
    geometry = "".join('AttributeBegin\nSurface "widths" "k" [%d]\nTranslate %d %d 9\nSphere 1.3 -1.3 1.3 360\nAttributeEnd\n'
                       % (1 + (x + y) % 2, x, y) for x in range(-4, 5, 2) for y in range(-3, 4, 2))
    scene = world("", geometry)
    with Folder() as folder:
        check_same(folder, shaders, scene, scene)


def test_a_displacement_shades_as_if_the_surface_had_moved():
    shaders = {
        "lift": "displacement lift(float km = 0; output varying float lifted = 0;) {\n"
                "  vector d = vector \"shader\" (0, 0, km); lifted = km; P += d; N = -N; }",
        "show": "surface show(float scale = 1;) { float km = 0; displacement(\"lifted\", km);\n"
                "  Ci = color (zcomp(transform(\"world\", P)) / 16, km * scale, zcomp(normalize(N))); }",
        "plain": "surface plain(float km = 0; float scale = 1;) {\n"
                 "  Ci = color ((zcomp(transform(\"world\", P)) + 2 * km) / 16, km * scale, -zcomp(normalize(N))); }",
    }
    with Folder() as folder:
        check_same(folder, shaders,
                   world('Surface "show" "scale" [0.25]\nTransformBegin\nScale 1 1 2\nDisplacement "lift" "km" [3]\n'
                         "TransformEnd\n"),
                   world('Surface "plain" "km" [3] "scale" [0.25]\n'))


def test_an_atmosphere_comes_after_the_surface():
    shaders = {
        "dust": "volume dust(float distance = 1; color dusty = 1;) {\n"
                "  float d = 1 - exp(-length(I) / distance); Ci = mix(Ci, dusty, d); Oi = mix(Oi, 1, d); }",
        "plain": "surface plain() { float d = 1 - exp(-length(I) / 10); Ci = mix(Cs * t, color (0.5, 0, 1), d); }",
        "ramp": "surface ramp() { Ci = Cs * t; Oi = Os; }",
    }
    with Folder() as folder:
        check_same(folder, shaders,
                   world('Color 0.3 1 0.6\nSurface "ramp"\nAtmosphere "dust" "distance" [10] "dusty" [0.5 0 1]\n'),
                   world('Color 0.3 1 0.6\nSurface "plain"\n'))


def test_the_view_has_coordinate_systems():
    # 96 x 64 pixels, 50 degrees for the shorter side
    shaders = {
        "asks": "surface asks() { point n = transform(\"NDC\", P), r = transform(\"raster\", P), s = transform(\"screen\", P);\n"
                "  point back = transform(\"screen\", \"current\", s);\n"
                "  Ci = color (xcomp(n) + xcomp(r) / 96, ycomp(n) + ycomp(r) / 64, xcomp(s) + distance(back, P)); }",
        "knows": "surface knows() { float h = tan(radians(25)), x = xcomp(P) / zcomp(P) / h, y = ycomp(P) / zcomp(P) / h;\n"
                 "  Ci = color (2 * (x / 3 + 0.5), 2 * (0.5 - y / 2), x * h); }",
    }
    with Folder() as folder:
        check_same(folder, shaders, world('Surface "asks"\n'), world('Surface "knows"\n'), 1e-4)


def test_options_of_the_scene_are_known():
    shaders = {
        "asks": "surface asks() { float f[3], c[2]; float ok = option(\"Format\", f) * option(\"Clipping\", c);\n"
                "  Ci = color (f[0] / 96, f[1] / 64 * c[0] * c[1] / 20, ok * depth(P)); }",
        "knows": "surface knows() { Ci = color (1, 1, (zcomp(P) - 1) / 19); }",
    }
    with Folder() as folder:
        check_same(folder, shaders, world('Surface "asks"\n'), world('Surface "knows"\n'))


def test_coordinate_systems_of_the_scene_have_names():
    shaders = {
        "asks": "surface asks(string where = \"here\";) {\n"
                "  point a = transform(\"marked\", P), b = transform(where, P);\n"
                "  Ci = color (xcomp(a), ycomp(b), zcomp(transform(\"nowhere at all\", P))) / 10; }",
        "knows": "surface knows() { Ci = color ((xcomp(P) - 1) / 2, ycomp(P) + 3, zcomp(P)) / 10; }",
    }
    marks = ('TransformBegin\nTranslate 1 0 0\nScale 2 2 2\nCoordinateSystem "marked"\nTransformEnd\n'
             'TransformBegin\nTranslate 0 -3 0\nCoordinateSystem "there"\nTransformEnd\n')
    with Folder() as folder:
        check_same(folder, shaders, world('Surface "asks" "where" ["there"]\n', lights=marks), world('Surface "knows"\n'))


def test_a_transform_can_be_taken_back_by_name():
    with Folder() as folder:
        moved = ('TransformBegin\nTranslate 0 0 6\nRotate 30 0 1 0\nCoordinateSystem "centre"\nTransformEnd\n'
                 'Surface "constant"\nAttributeBegin\nTranslate 5 5 5\nCoordSysTransform "centre"\n')
        plain = 'Surface "constant"\nAttributeBegin\nTranslate 0 0 6\nRotate 30 0 1 0\n'
        ball = "Color 1 0.5 0\nCylinder 1 -1 1 360\nAttributeEnd\n"
        check_same(folder, {}, world(moved, ball), world(plain, ball))


def test_lights_have_categories_and_answer():
    shaders = {
        "lamp": "light lamp(float level = 1; string __category = \"\"; float __weight = 0;) {\n"
                "  solar (vector \"world\" (0, 0, 1), 0) Cl = level; }",
        "asks": "surface asks() { color key = 0; float weights = 0;\n"
                "  illuminance (\"key\", P) { float w = 0; key += Cl; lightsource(\"__weight\", w); weights += w; }\n"
                "  illuminance (\"-key\", P) weights += 8 * comp(Cl, 0);\n"
                "  Ci = color (comp(key, 0), weights, 0); }",
        "knows": "surface knows() { Ci = color (0.5, 3 + 8 * 0.25, 0); }",
    }
    lights = ('LightSource "lamp" 1 "level" [0.5] "string __category" ["warm,key"] "float __weight" [3]\n'
              'LightSource "lamp" 2 "level" [0.25]\n')
    with Folder() as folder:
        check_same(folder, shaders, world('Surface "asks"\n', lights=lights), world('Surface "knows"\n'))


def test_matrices_and_strings_come_from_the_scene():
    shaders = {
        "asks": "surface asks(matrix turn = 1; string names[2] = {\"a\", \"b\"}; matrix many[2] = {1, 2};) {\n"
                "  vector v = vtransform(turn, vector (0.1, 0.2, 0.4));\n"
                "  Ci = color (v) + (concat(names[0], \"-\", names[1]) == \"left-right\" ? 0.5 : 0)\n"
                "     + comp(many[1], 2, 2); }",
        "knows": "surface knows() { Ci = color (0.2, 0.4, 0.1) + 0.5 + 2; }",
    }
    matrix = "[0 0 1 0  1 0 0 0  0 1 0 0  0 0 0 1]"
    with Folder() as folder:
        check_same(folder, shaders,
                   world('Surface "asks" "uniform matrix turn" %s "uniform string names[2]" ["left" "right"]\n' % matrix),
                   world('Surface "knows"\n'))


def test_shaders_of_another_kind_are_refused_where_they_are_asked_for():
    with Folder() as folder:
        folder.write("bump.sl", "displacement bump() { P += N; }")
        scene = folder.write("wrong.rib", world('Surface "bump"\n'))
        code, out, err = folder.run("render", scene, "-o", folder.file("x.exr"))
        assert code == 1 and "\"bump\" is a displacement shader, a surface shader is needed here" in err, err
        scene = folder.write("wrong.rib", world('Displacement "matte"\n'))
        code, out, err = folder.run("render", scene, "-o", folder.file("x.exr"))
        assert code == 1 and "matte is a surface shader, and is used as displacement shader" in err, err


main(globals())
