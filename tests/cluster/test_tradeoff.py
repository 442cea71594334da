# SPDX-License-Identifier: Apache-2.0
"""`sortlast tradeoff`: every number on the frontier is that of a run of its own, nothing beats the frontier, limits choose,
and an interrupted study goes on. Knobs charge what they save."""

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
        fast = ",".join(name[5:] for name, value in setting.items() if name.startswith("math.") and value == "fast")
        arguments = ["--samples", setting["samples"], "--chord", setting["chord"], "--parameters", setting["parameters"]]
        summary = folder.render(folder.file("scene.rib"), "--driver", "in-process", "-o", folder.file("again.exr"),
                                *arguments, *(["--fast-shaders", fast] if fast else []))
        assert summary["frames"][0]["time_ps"] == chosen["time_ps"]
        code, out, err = folder.run("compare", folder.file("study/reference.exr"), folder.file("again.exr"), "--only",
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


def test_half_parameters_are_rounded_and_charged_as_halves():
    with harness.Folder() as folder:
        os.makedirs(folder.file("shaders"))
        folder.write("shaders/show.sl", "surface show() { Ci = color (s, t, 0); }\n")
        scene = folder.write("half.rib", 'Format 64 8 1\nProjection "orthographic"\nScreenWindow -1 1 -1 1\nWorldBegin\n'
                             'Surface "show"\nPolygon "P" [-1 -1 2 1 -1 2 1 1 2 -1 1 2] "s" [0 70000 70000 0] '
                             '"t" [0 0 1 1]\nWorldEnd\n')
        pictures, summaries = [], []
        for kind in ["float", "half"]:
            summaries.append(folder.render(scene, "--driver", "in-process", "--parameters", kind, "-o",
                                           folder.file(kind + ".exr"), "--compression", "none"))
            pictures.append(harness.read_exr(folder.file(kind + ".exr")))
        for channel in "RG":
            for row in range(8):
                for exact, rounded in zip(pictures[0][channel][row], pictures[1][channel][row]):
                    wanted = struct.unpack("<e", struct.pack("<e", min(exact, 65504)))[0]
                    assert rounded == wanted, (channel, exact, rounded, wanted)
        maps = [summary["instances"][0]["transfer_map_bytes"] for summary in summaries]
        assert maps == [10, 6], maps
        parameters = [summary["frames"][0]["composition"]["bytes"]["parameters"] for summary in summaries]
        assert parameters == [64 * 8 * 8, 64 * 8 * 4], parameters
        bytes_ = summaries[1]["frames"][0]["composition"]["bytes"]
        assert bytes_["total"] == sum(bytes_[k] for k in ["depth", "shader_id", "parameters", "padding"])


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


if __name__ == "__main__":
    harness.main(globals())
