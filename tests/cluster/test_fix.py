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
        light = folder.write("lamp/stripes.sl", "light stripes(float count = 1;) { solar () Cl = 1; }")
        for arguments, said in (
                ([quiet, "--fix", scene], "no surface of the scene has the shader \"quiet\""),
                ([fixed, "--fix", scene], "stripes.sl:1:52: error: this cannot be written as source with other types"),
                ([light, "--fix", scene], "is a light shader"),
                ([random, "--fix", scene], "stripes.sl:1:42: error: this cannot be written as source with other types"),
                ([stripes, "--fix", folder.file("none.rib")], "none.rib"),
                ([stripes, "--fix", scene, "--max-error", "2/0"], "--max-error"),
                ([stripes, "--fix", scene, "--max-error", "-1"], "--max-error"),
                ([stripes, "--fix", scene, "--max-error", "1e-9", "--outliers", "0"], "the least error reached is"),
                ([stripes, "--fix", scene, "--outliers", "2"], "--outliers"),
                ([stripes, "--fix", scene, "--frames", "0"], "--frames")):
            code, out, err = folder.run("shader", *arguments, "-o", folder.file("out.sl"))
            assert code == 1 and said in err, (arguments, code, err)
            assert not os.path.exists(folder.file("out.sl"))


harness.main(globals())
