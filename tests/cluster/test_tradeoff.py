# SPDX-License-Identifier: Apache-2.0
"""`sortlast tradeoff`: every number on the frontier is that of a run of its own, nothing beats the frontier, limits choose,
and an interrupted study goes on. Knobs charge what they save."""

import fractions
import json
import os
import struct

import harness

SCENE = """Format 96 64 1
Projection "perspective" "fov" [60]
WorldBegin
LightSource "distant" 1
Translate 0 0 4
Surface "marble"
Sphere 1 -1 1 360
Translate 1.2 0 0
Surface "plastic"
Sphere 0.8 -0.8 0.8 360
WorldEnd
"""
SIZE = ["--reference-samples", "16"]


def tradeoff(folder, *arguments):
    scene = folder.write("scene.rib", SCENE)
    code, out, err = folder.run("tradeoff", scene, "-o", folder.file("study"), *SIZE, *arguments, timeout=400)
    document = None
    if os.path.exists(folder.file("study/tradeoff.json")):
        with open(folder.file("study/tradeoff.json")) as file:
            document = json.load(file)
    return code, out, err, document


def test_the_frontier_is_what_no_other_setting_beats_and_its_numbers_can_be_had_again():
    with harness.Folder() as folder:
        code, out, err, study = tradeoff(folder, "--runs", "14", "--min-psnr", "20")
        assert code == 0, err
        results = study["results"]
        base = results[0]
        assert all(knob["values"][0] == base["setting"][knob["name"]] for knob in study["knobs"])
        for a in results:
            beaten = any(b["time_ps"] <= a["time_ps"] and b["square_error"] <= a["square_error"]
                         and (b["time_ps"], b["square_error"]) != (a["time_ps"], a["square_error"]) for b in results)
            assert not (a["on_frontier"] and beaten), a["setting"]
            assert a["on_frontier"] or beaten or any(b["on_frontier"] and b["time_ps"] == a["time_ps"]
                                                     and b["square_error"] == a["square_error"] for b in results)
        # the quickest of those within the limit
        chosen = results[study["chosen"]]
        assert chosen["psnr_db"] >= 20
        assert chosen["time_ps"] == min(r["time_ps"] for r in results if r["psnr_db"] >= 20)
        assert chosen["time_ps"] < base["time_ps"]
        # a run by hand says the same
        setting = chosen["setting"]
        fast = ",".join(name[5:] for name, value in setting.items() if name in ("math.marble", "math.plastic") and
                        value == "fast")
        calls = ",".join("marble:" + name[12:] for name, value in setting.items() if name.startswith("math.marble.") and
                         value == "fast")
        arguments = ["--samples", setting["samples"], "--chord", setting["chord"], "--parameters", setting["parameters"]]
        summary = folder.render(folder.file("scene.rib"), "--driver", "in-process", "-o", folder.file("again.exr"),
                                *arguments, *(["--fast-shaders", fast] if fast else []), *(["--fast-calls", calls] if calls else []))
        assert summary["frames"][0]["time_ps"] == chosen["time_ps"]
        code, out, err = folder.run("compare", folder.file("study/reference-0001.exr"), folder.file("again.exr"), "--only",
                                    "R,G,B", "--json", "-")
        assert abs(json.loads(out)["psnr_db"] - chosen["psnr_db"]) < 1e-6
        # the page shows the frontier, each with its picture
        with open(folder.file("study/index.html")) as page:
            text = page.read()
        for result in results:
            assert os.path.exists(folder.file("study/" + result["picture"]))
            assert (result["picture"] in text) == (result["on_frontier"] or result is chosen)


def test_a_study_goes_on_where_it_stopped_and_another_is_refused():
    with harness.Folder() as folder:
        code, out, err, first = tradeoff(folder, "--runs", "3")
        assert code == 0 and len(first["results"]) == 3, err
        code, out, err, more = tradeoff(folder, "--runs", "5")
        assert code == 0 and len(more["results"]) == 5, err
        for a, b in zip(first["results"], more["results"]):
            assert a["setting"] == b["setting"] and a["wall_s"] == b["wall_s"]
        code, out, err, _ = tradeoff(folder, "--runs", "5", "--format", "32x32")
        assert code == 1 and "another study" in err, err
        code, out, err, _ = tradeoff(folder, "--runs", "5", "--min-psnr", "200")
        assert code == 1 and "no setting is within the limits" in err, err


def fixed(value, bits, signed, exponent):
    """The nearest fixed-point number, ties to even, within the format."""
    least, most = (-2 ** (bits - 1), 2 ** (bits - 1) - 1) if signed else (0, 2 ** bits - 1)
    return max(least, min(most, round(fractions.Fraction(value) * fractions.Fraction(2) ** exponent))) / 2 ** exponent


def test_parameters_are_rounded_and_charged_as_they_travel():
    with harness.Folder() as folder:
        os.makedirs(folder.file("shaders"))
        folder.write("shaders/show.sl", "surface show(varying normal n = normal \"camera\" (0, 0, 0); varying fixed<24,20> f = 0;) {\n"
                     "    Ci = color (s, zcomp(n), f);\n}\n")
        # of two polygons of one instance the second has the largest s: the format is the instance's
        polygon = ('Polygon "P" [-1 %g 2 1 %g 2 1 %g 2 -1 %g 2] "s" [0 %g %g 0] '
                   '"varying normal n" [0 0 -1 0 0.6 -0.8 0.6 0 0.8 0 1 0] "varying float f" [-0.3 0.7 0.7 -0.3]\n')
        scene = folder.write("show.rib", 'Format 64 16 1\nProjection "orthographic"\nScreenWindow -1 1 -1 1\nWorldBegin\n'
                             'Surface "show"\n' + polygon % (-1, -1, 0, 0, 3, 3) + polygon % (0, 0, 1, 1, 70000, 70000) + "WorldEnd\n")
        pictures, summaries = {}, {}
        kinds = ["float", "half", "fixed", "byte"]
        for kind in kinds:
            for r, s, driver in [(1, 1, "in-process"), (3, 2, "processes")]:
                summary = folder.render(scene, "-r", r, "-s", s, "--driver", driver, "--parameters", kind, "-o",
                                        folder.file(kind + ".exr"), "--compression", "none")
                picture = harness.read_exr(folder.file(kind + ".exr"))
                assert pictures.setdefault(kind, picture) == picture, (kind, driver)
            summaries[kind] = summary

        def single(value):
            return struct.unpack("<f", struct.pack("<f", value))[0]

        def half(value):
            return struct.unpack("<e", struct.pack("<e", min(value, 65504)))[0]
        rounding = {"half": {"R": half, "G": half},
                    "fixed": {"R": lambda v: fixed(v, 16, False, -1), "G": lambda v: fixed(v, 16, True, 15)},
                    "byte": {"R": lambda v: fixed(v, 16, False, -1), "G": lambda v: fixed(v, 8, True, 7)}}
        for kind in kinds[1:]:
            for channel, nearest in rounding[kind].items():
                for exact, rounded in zip(pictures["float"][channel], pictures[kind][channel]):
                    for a, b in zip(exact, rounded):
                        assert b == single(nearest(a)), (kind, channel, a, b)
            assert pictures[kind]["B"] == pictures["float"]["B"]  # fixed-point of the language stays
        # s: 4, 2, 2, 2 bytes; a normal 12, 6, 6, 3; f always 3
        maps = [summaries[kind]["instances"][0]["transfer_map_bytes"] for kind in kinds]
        assert maps == [2 + 4 + 12 + 3, 2 + 2 + 6 + 3, 2 + 2 + 6 + 3, 2 + 2 + 3 + 3], maps
        for kind, size in zip(kinds, maps):
            bytes_ = summaries[kind]["frames"][0]["composition"]["bytes"]
            assert bytes_["parameters"] == 64 * 16 * (size - 2), (kind, bytes_)
            assert bytes_["total"] == sum(bytes_[k] for k in ["depth", "shader_id", "parameters", "padding"])


def test_assigning_regions_by_cost_is_a_knob_that_takes_no_accuracy():
    with harness.Folder() as folder:
        # two spheres in a wide picture: few regions cost something, and it is chance which nodes have them
        scene = folder.write("scene.rib", SCENE.replace("96 64", "576 128"))
        study = folder.file("study")
        arguments = ["tradeoff", scene, "-o", study, "--reference-samples", "1", "-r", "6", "-s", "3", "--runs", "9"]
        code, out, err = folder.run(*arguments)
        assert code == 0, err
        document = json.load(open(folder.file("study/tradeoff.json")))
        base = document["results"][0]
        assert base["setting"]["assignment"] == "round-robin"
        changed = [r for r in document["results"] if r["setting"]["assignment"] == "by-cost"]
        assert len(changed) == 1, document["results"]
        for key in ("psnr_db", "max_error", "flip_mean", "shading_ps"):
            assert changed[0][key] == base[key], key
        # by hand
        common = ["-r", "6", "-s", "3", "--samples", "16", "--driver", "in-process"]
        first = folder.render(scene, *common, "--record", folder.file("run.rec"))
        second = folder.render(scene, *common, "--assignment", "by-cost", "--costs-from", folder.file("run.rec"))
        assert first["frames"][0]["time_ps"] == base["time_ps"]
        assert second["frames"][0]["time_ps"] == changed[0]["time_ps"] < base["time_ps"], (second["frames"], base)
        assert "costs.record" not in os.listdir(study)


def test_fast_functions_of_one_shader_leave_the_others_exact():
    with harness.Folder() as folder:
        scene = folder.write("scene.rib", SCENE)

        def render(name, *arguments):
            folder.render(scene, "--driver", "in-process", "-o", folder.file(name + ".exr"), "--compression", "none",
                          *arguments)
            return harness.read_exr(folder.file(name + ".exr"))
        exact, fast = render("exact"), render("fast", "--math", "fast")
        one = render("one", "--fast-shaders", "plastic,nobody")
        differing = 0
        for row in range(64):
            for column in range(96):
                which = exact["shaderID"][row][column]
                wanted = fast if which == 2 else exact
                for channel in "RGB":
                    assert one[channel][row][column] == wanted[channel][row][column]
                differing += exact["R"][row][column] != one["R"][row][column]
        assert differing > 0


def test_shaders_made_fixed_point_are_knobs():
    with harness.Folder() as folder:
        os.makedirs(folder.file("shaders"))
        folder.write("shaders/waves.sl", "surface waves(float count = 6;) {\n    float x = count * s - floor(count * s);\n"
                     "    Ci = color (x * (1 - x) * 4, t * t, sqrt(x) / (1 + t));\n}\n")
        folder.write("shaders/plain.sl", "surface plain() { fixed<8,4> x = s; Ci = x; }\n")
        patch = 'Patch "bilinear" "P" [-1 %g 0 1 %g 0 -1 %g 0 1 %g 0]\n'
        scene = folder.write("scene.rib", 'Format 48 48 1\nProjection "orthographic"\nTranslate 0 0 1\nWorldBegin\n'
                             'Surface "waves"\n' + patch % (1, 1, 0, 0) + 'Surface "plain"\n' + patch % (0, 0, -1, -1) +
                             "WorldEnd\n")
        arguments = ["tradeoff", scene, "-o", folder.file("study"), *SIZE, "--runs", "10", "--fixed", "4/255"]
        code, out, err = folder.run(*arguments)
        assert code == 0, err
        assert "it has fixed-point numbers already" in err  # plain has no knob, and that is said
        study = json.load(open(folder.file("study/tradeoff.json")))
        assert [k["name"] for k in study["knobs"] if k["name"].startswith("fixed.")] == ["fixed.waves"]
        base = study["results"][0]
        only = [r for r in study["results"] if [k for k in r["setting"] if r["setting"][k] != base["setting"][k]] == ["fixed.waves"]]
        assert len(only) == 1 and only[0]["shading_ps"] < base["shading_ps"], study["results"]
        assert only[0]["max_error"] <= base["max_error"] + 5 / 255
        # by hand: the file in the study's folder, whatever the scene's own folders have
        fixed = folder.file("study/fixed-4_255/waves.sl")
        summary = folder.render(scene, "--driver", "in-process", "--samples", "16", "--use", "waves=" + fixed)
        assert summary["frames"][0]["time_ps"] == only[0]["time_ps"]
        twice = folder.render(scene, "--driver", "in-process", "--samples", "16", "--use", "waves=none.sl", "--use", "waves=" + fixed)
        assert twice["frames"][0]["time_ps"] == only[0]["time_ps"]  # the last counts
        code, out, err = folder.run("render", scene, "--use", "waves=" + folder.file("none.sl"))
        assert code == 1 and "scene.rib:5:1: error: cannot open" in err and "none.sl" in err, err
        code, out, err = folder.run("render", scene, "--use", "waves")
        assert code == 1 and "--use is NAME=FILE.sl" in err, err


ANIMATED = """Format 64 32 1
FrameBegin 1
Projection "perspective" "fov" [60]
WorldBegin
LightSource "distant" 1
Translate 0 0 4
Surface "plastic" "roughness" [0.5]
Sphere 1.5 -1.5 1.5 360
WorldEnd
FrameEnd
FrameBegin 2
Projection "perspective" "fov" [60]
WorldBegin
LightSource "distant" 1
Translate 0 0 4
Surface "plastic" "roughness" [0.004]
Sphere 1.5 -1.5 1.5 360
WorldEnd
FrameEnd
"""


def test_a_choice_is_judged_on_frames_that_had_no_part_in_it():
    """Fast powers are harmless for the wide highlight of frame 1 and visible in the narrow one of frame 2."""
    with harness.Folder() as folder:
        scene = folder.write("animated.rib", ANIMATED)

        def study(name, *arguments):
            code, out, err = folder.run("tradeoff", scene, "-o", folder.file(name), "--reference-samples", "4",
                                        *arguments, timeout=400)
            with open(folder.file(name + "/tradeoff.json")) as file:
                return code, out, err, json.load(file)

        code, out, err, both = study("one", "--runs", "1", "--min-psnr", "10")
        assert code == 0, err
        assert (both["tune_frames"], both["judge_frames"]) == ([1], [2])
        base = both["results"][0]
        # frame 2 by itself says what the judge says
        folder.render(scene, "--driver", "in-process", "--skip", "1", "--frames", "1", "--samples", "16", "-o",
                      folder.file("again.exr"))
        code, out, err = folder.run("compare", folder.file("one/reference-0002.exr"), folder.file("again.exr"), "--only",
                                    "R,G,B", "--json", "-")
        assert abs(json.loads(out)["psnr_db"] - base["judged"]["psnr_db"]) < 1e-6
        code, out, err, none = study("none", "--runs", "1", "--judge-frames", "none")
        assert code == 0 and none["results"][0]["judged"] is None and none["judge_frames"] == [], err
        # a limit that only the base keeps on both frames: what is quicker on frame 1 is refused for frame 2
        code, out, err, all_runs = study("two", "--runs", "4")
        limit = min(base["psnr_db"], base["judged"]["psnr_db"]) - 0.01
        code, out, err, chosen = study("two", "--runs", "4", "--min-psnr", str(limit))
        assert code == 0, err
        picked = chosen["results"][chosen["chosen"]]
        assert picked["judged"]["psnr_db"] >= limit and picked["psnr_db"] >= limit
        for r in chosen["results"]:
            if r["psnr_db"] >= limit and r["time_ps"] < picked["time_ps"]:
                assert r["judged"]["psnr_db"] < limit and r["refused"], r["setting"]
            assert r["refused"] == (r["psnr_db"] >= limit and r["judged"] is not None and
                                    r["judged"]["psnr_db"] < limit), r
        for frames in [["--judge-frames", "1"], ["--judge-frames", "3"], ["--tune-frames", "2-1"], ["--tune-frames", "x"]]:
            code, out, err = folder.run("tradeoff", scene, "-o", folder.file("bad"), *frames)
            assert code == 1 and ("frame" in err), err


def test_one_call_of_a_shader_is_fast_and_the_other_exact():
    with harness.Folder() as folder:
        scene = folder.write("scene.rib", SCENE)

        def render(name, *arguments):
            summary = folder.render(scene, "--driver", "in-process", "-o", folder.file(name + ".exr"), "--compression",
                                    "none", *arguments)
            return summary, harness.read_exr(folder.file(name + ".exr"))
        exact, _ = render("exact")
        places = ["%s:%d:%d" % (c["shader"], c["line"], c["column"]) for c in exact["calls"] if c["shader"] == "marble"]
        assert [c["function"] for c in exact["calls"] if c["shader"] == "marble"] == ["sin", "pow"], exact["calls"]
        shader, all_fast = render("shader", "--fast-shaders", "marble")
        both, one_by_one = render("both", "--fast-calls", ",".join(places))
        assert one_by_one == all_fast and both["frames"][0]["time_ps"] == shader["frames"][0]["time_ps"]
        record = folder.file("one.record")
        one, picture = render("one", "--fast-calls", places[0], "--record", record)
        assert shader["frames"][0]["time_ps"] < one["frames"][0]["time_ps"] < exact["frames"][0]["time_ps"]
        assert [c["math"] for c in one["calls"] if c["shader"] == "marble"] == ["fast", "exact"]
        # a cluster of processes draws the same, and a record of the run answers for all functions exact or fast
        folder.render(scene, "-r", "2", "-s", "2", "--fast-calls", places[0], "-o", folder.file("cluster.exr"),
                      "--compression", "none")
        assert harness.read_exr(folder.file("cluster.exr")) == picture
        fast, _ = render("fast", "--math", "fast")
        for math, run in [("exact", exact), ("recorded", one), ("fast", fast)]:
            code, out, err = folder.run("predict", record, "--math", math, "--json", "-", "-q")
            assert code == 0, err
            assert json.loads(out)["combinations"][0]["time_ps"] == run["frames"][0]["time_ps"], math
        other, _ = render("other", "--fast-calls", "nobody:1:1")
        assert other["frames"][0]["time_ps"] == exact["frames"][0]["time_ps"]
        assert any('no shader "nobody"' in w for w in other["warnings"]), other
        for bad, words in [("marble:1:2", "marble has: sin at 30:30, pow at 45:18"), ("marble:30", "SHADER:LINE:COLUMN"),
                           ("30:30", "SHADER:LINE:COLUMN"), ("marble:0:1", "SHADER:LINE:COLUMN")]:
            code, out, err = folder.run("render", scene, "--fast-calls", bad)
            assert code != 0 and words in err, err


if __name__ == "__main__":
    harness.main(globals())
