# SPDX-License-Identifier: Apache-2.0
"""Shaders made fixed-point by themselves: the source that comes out is one to compile like any other, stays within the
error asked for, and costs less. Written with floats only, it computes the same bits."""

import json
import os

import harness

LIBRARY = os.path.join(harness.SOURCE, "shaders", "library")
SURFACES = ["bowling_pin", "fancy_brick", "mandelbrot", "marble", "ripple_reflection"]
BRICKS = os.path.join(harness.SOURCE, "scenes", "bricks", "bricks.rib")
# one shader alone on the screen, with a floor to decide on
QUICK = """Format 64 64 1
PixelSamples 2 2
Projection "orthographic"
Translate 0 0 1
WorldBegin
Surface "stripes" "uniform float count" [5]
Patch "bilinear" "P" [-1 1 0 1 1 0 -1 -1 0 1 -1 0]
WorldEnd
"""
STRIPES = """surface stripes(float count = 3; color dark = color (0.2, 0.1, 0.05); color light = color (0.8, 0.7, 0.6);) {
    float x = count * s;
    float phase = x - floor(x);
    float soft = smoothstep(0.2, 0.4, phase) * (1 - smoothstep(0.6, 0.8, phase));
    float shade = 0.6 + 0.4 * sqrt(soft) / (1 + t);
    if (t > 0.5)
        shade *= 0.5 + t;
    Ci = mix(dark, light, soft) * shade;
}
"""


def test_the_source_that_is_written_computes_the_same_bits():
    with harness.Folder() as folder:
        for name in SURFACES:
            path = os.path.join(LIBRARY, name + ".sl")
            code, out, err = folder.run("shader", path, "--source")
            assert code == 0, err
            again = folder.write(name + "_again.sl", out)
            pictures = []
            for source in (path, again):
                pictures.append(folder.file(os.path.basename(source) + ".exr"))
                code, out, err = folder.run("shader", source, "--render", "--format", "64x64", "--shaders", LIBRARY,
                                            "-o", pictures[-1])
                assert code == 0, err
            code, out, err = folder.run("compare", *pictures)
            assert code == 0, "%s: %s" % (name, out)


# what has been written wrongly once, or must be refused: the message
NASTY = {
    "copies": ("surface copies() { float x = s; if (t > 0.5) x = 0.2; Ci = x; }", None),
    "lights": ("surface lights() { color sum = 0; illuminance (P) { vector l = L; if (s > 0.5) l = -l; color c = Cl; "
               "if (t > 0.5) c = c * s; sum += c * (normalize(l) . N); } Ci = sum; }", None),
    "last": ("surface last() { vector l = 0; illuminance (P) { l = L; } Ci = color (l); }", None),
    "loops": ("surface loops() { float i, j, n = 0; for (i = 0; i < 6; i += 1) for (j = 0; j < 6; j += 1) { "
              "if (i * j > 8 * s) continue 2; if (t < 0.2) break; n += noise(i * s, j); } Ci = n / 9; }", None),
    "comments": ('surface comments /* (a) */ (float k = 0.5; // x) y\n string a = "x\\")(";) { Ci = k * s; }', None),
    "option": ('surface option() { float f[3] = {0, 0, 0}; float x = option("Format", f); Ci = color (f[0] / 1000, x, s); }',
               "cannot be written"),
    "loop": ("float f(float x) { float w[2]; w[x * s] += 0.5 + x * 0.1; return w[0] + w[1]; }\n"
             "surface loop() { float i = 0; while (f(i) < 0.5 + t * 0.4 && i < 10) i += 1; Ci = i / 10; }",
             "the condition of a loop"),
    "hides": ("float g() { return s; } surface hides(float s = 0.25;) { Ci = s + g(); }", "hides a predefined variable"),
    "macro": ("#define K 3\nsurface macro(float k = K;) { Ci = k * s; }", "macros or functions"),
}


def test_nasty_shaders_are_written_right_or_refused():
    with harness.Folder() as folder:
        for name, (text, refusal) in NASTY.items():
            path = folder.write(name + ".sl", text)
            code, out, err = folder.run("shader", path, "--source")
            if refusal:
                assert code == 1 and refusal in err, (name, code, err)
                continue
            assert code == 0, (name, err)
            again = folder.write(name + "_again.sl", out)
            for source in (path, again):
                code, _, err = folder.run("shader", source, "--render", "--format", "32x32", "-o", source + ".exr")
                assert code == 0, (name, err)
            code, report, err = folder.run("compare", path + ".exr", again + ".exr")
            assert code == 0, (name, report, out)


def test_one_of_several_variants_is_looked_at_and_frames_may_differ_in_size():
    with harness.Folder() as folder:
        shader = folder.write("stripes.sl", STRIPES)
        os.makedirs(folder.file("scene"))
        patch = 'Patch "bilinear" "P" [-1 %g 0 1 %g 0 -1 %g 0 1 %g 0]'
        world = 'Projection "orthographic"\nTranslate 0 0 1\nWorldBegin\n%s\nWorldEnd\n'
        two = 'Surface "stripes" "uniform float count" [3]\n' + patch % (1, 1, 0, 0) + '\nSurface "stripes"\n' + \
            patch % (0, 0, -1, -1) + ' "varying float count" [3 3 5 5]'
        scene = folder.write("scene/two.rib", "FrameBegin 1\nFormat 64 64 1\n" + world % two + "FrameEnd\n"
                             "FrameBegin 2\nFormat 32 32 1\n" + world % two + "FrameEnd\n")
        _, report, _ = fix(folder, shader, scene, "--frames", "2", "--outliers", "0.001")
        assert report["after"]["error"] <= 2 / 255


def fix(folder, shader, scene, *arguments):
    output, report = folder.file("fixed.sl"), folder.file("fix.json")
    code, out, err = folder.run("shader", shader, "--fix", scene, "-o", output, "--json", report, *arguments)
    assert code == 0, err
    return output, json.load(open(report)), out


def quick_scene(folder):
    """In a folder of its own: shaders beside a scene come first."""
    os.makedirs(folder.file("scene"), exist_ok=True)
    return folder.write("scene/quick.rib", QUICK)


def difference(folder, scene, shaders, reference):
    """The picture of the scene with a folder of shaders, against double precision."""
    picture = folder.file("picture.exr")
    folder.render(scene, "--driver", "in-process", "--shaders", shaders, "-o", picture)
    code, out, err = folder.run("compare", reference, picture, "--only", "R,G,B", "--max-error", "1", "--json", "-")
    assert code == 0, err
    return json.loads(out)


def test_a_shader_becomes_fixed_point_and_stays_within_the_error():
    with harness.Folder() as folder:
        shader, scene = folder.write("stripes.sl", STRIPES), quick_scene(folder)
        reference = folder.file("reference.exr")
        folder.render(scene, "--driver", "in-process", "--math", "reference", "--shaders", folder.path, "-o", reference)
        times = []
        for bound in (0.02, 0.002):
            output, report, out = fix(folder, shader, scene, "--max-error", str(bound), "--outliers", "0")
            assert "surface fixed(" in open(output).read() and "fixed<" in open(output).read()
            os.makedirs(folder.file("fixed"), exist_ok=True)
            os.replace(output, folder.file("fixed/stripes.sl"))
            measured = difference(folder, scene, folder.file("fixed"), reference)
            assert measured["max_error"] <= bound
            assert abs(measured["max_error"] - report["after"]["max_error"]) < 1e-3, (measured["max_error"], report)
            assert report["after"]["time_per_region_ps"] * 2 < report["before"]["time_per_region_ps"]
            # what the report says it costs is what the shader by itself says
            code, text, err = folder.run("shader", folder.file("fixed/stripes.sl"), "--json", "-")
            alone = json.loads(text)
            assert alone["time_per_region_ps"]["exact"] == report["after"]["time_per_region_ps"]
            assert alone["memory"]["allocated"] == report["after"]["allocated_bytes"]
            times.append(report["after"]["time_per_region_ps"])
        assert times[0] < times[1], times  # more error allowed, less time


def test_what_fixed_point_cannot_do_as_exactly_stays_a_float():
    noisy = STRIPES.replace("    if (t > 0.5)", "    shade += 0.2 * noise(4 * s, 4 * t);\n    if (t > 0.5)")
    with harness.Folder() as folder:
        shader, scene = folder.write("stripes.sl", noisy), quick_scene(folder)
        for bound, is_float in ((0.01, False), (2e-5, True)):  # the noise of fixed-point is good to 2^-12
            output, report, _ = fix(folder, shader, scene, "--max-error", str(bound), "--outliers", "0")
            line = [line for line in open(output) if " noise(" in line or "(noise(" in line][-1]
            assert ("float noise(" in line) == is_float, line
            assert report["after"]["max_error"] <= bound
            assert report["after"]["time_per_region_ps"] < report["before"]["time_per_region_ps"]


def test_values_that_were_seen_fit_their_formats():
    with harness.Folder() as folder:
        _, report, _ = fix(folder, folder.write("stripes.sl", STRIPES), quick_scene(folder))
        kinds = [v["type"] for v in report["variables"]]
        assert sum("fixed<" in kind for kind in kinds) > len(kinds) / 2
        for v in report["variables"]:
            if v["type"] == "float":
                continue
            size, exponent = (int(part) for part in v["type"].split("<")[1].strip(">").split(","))
            is_unsigned = v["type"].startswith("unsigned")
            top = 2.0 ** (size - exponent - (0 if is_unsigned else 1))
            assert v["highest"] < top and v["lowest"] >= (0 if is_unsigned else -top), v


def test_fancy_brick_is_twice_as_fast_within_2_of_255():
    with harness.Folder() as folder:
        output, report, out = fix(folder, os.path.join(LIBRARY, "fancy_brick.sl"), BRICKS, "--format", "80x64")
        assert report["after"]["error"] <= 2 / 255
        assert int(report["after"]["pixels_beyond"]) <= 1e-4 * 80 * 64
        ratio = int(report["before"]["time_per_region_ps"]) / int(report["after"]["time_per_region_ps"])
        assert ratio >= 2, ratio


def test_what_cannot_be_done_is_said():
    with harness.Folder() as folder:
        scene = quick_scene(folder)
        stripes = folder.write("stripes.sl", STRIPES)
        quiet = folder.write("quiet.sl", "surface quiet() { Ci = 1; }")
        os.makedirs(folder.file("fixed"))
        os.makedirs(folder.file("lamp"))
        os.makedirs(folder.file("random"))
        random = folder.write("random/stripes.sl", "surface stripes(float count = 1;) { Ci = random() * count; }")
        fixed = folder.write("fixed/stripes.sl", "surface stripes(float count = 1;) { fixed<8,4> x = s; Ci = x; }")
        os.makedirs(folder.file("cheap"))
        cheap = folder.write("cheap/stripes.sl", "surface stripes(float count = 1;) { Ci = color (s, t, s * count); }")
        light = folder.write("lamp/stripes.sl", "light stripes(float count = 1;) { solar () Cl = 1; }")
        for arguments, said in (
                ([quiet, "--fix", scene], "no surface of the scene has the shader \"quiet\""),
                ([fixed, "--fix", scene], "stripes.sl:1:52: error: this cannot be written as source with other types"),
                ([light, "--fix", scene], "is a light shader"),
                ([random, "--fix", scene], "stripes.sl:1:42: error: this cannot be written as source with other types"),
                ([stripes, "--fix", folder.file("none.rib")], "none.rib"),
                ([stripes, "--fix", scene, "--max-error", "2/0"], "--max-error"),
                ([stripes, "--fix", scene, "--max-error", "-1"], "--max-error"),
                ([stripes, "--fix", scene, "--max-error", "1e-9", "--outliers", "0"], "floats are not within 1e-09"),
                ([cheap, "--fix", scene], "fixed-point gains nothing here"),
                ([stripes, "--fix", scene, "--outliers", "2"], "--outliers"),
                ([stripes, "--fix", scene, "--frames", "0"], "--frames")):
            code, out, err = folder.run("shader", *arguments, "-o", folder.file("out.sl"))
            assert code == 1 and said in err, (arguments, code, err)
            assert not os.path.exists(folder.file("out.sl"))


harness.main(globals())
