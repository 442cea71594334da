# SPDX-License-Identifier: Apache-2.0
"""Records, predictions, budgets and timelines: what the analysis verbs say is what a live run says, to the tick."""

import csv
import json
import os
import xml.dom.minidom

from harness import SANITIZED, SCENES, SOURCE, Folder, main

BOWLING = os.path.join(SCENES, "bowling", "bowling.rib")
SOLID = os.path.join(SCENES, "solid", "solid.rib")
COINCIDENT = os.path.join(SCENES, "coincident", "coincident.rib")
IN_PROCESS = ("--driver", "in-process")

NAMES = ("roughness", "a", "b", "c", "d", "e", "f")
WIDE = """surface wide(%s)
{ Ci = color(roughness + a, b + c, d + e) * f; Oi = 1; }
""" % "; ".join("varying float %s = 0.1" % name for name in NAMES)
WIDE_SCENE = """Format 256 128 1
Projection "orthographic"
WorldBegin
Surface "wide" %s
Polygon "P" [-9 -9 1  9 -9 1  9 9 1  -9 9 1] %s
WorldEnd
"""


def analyse(folder, verb, *arguments):
    """Runs predict, budget or trace and returns the JSON it writes."""
    code, out, err = folder.run(verb, *arguments, "-q", "--json", folder.file("answer.json"))
    assert code == 0, "%s failed (%d): %s" % (verb, code, err)
    with open(folder.file("answer.json")) as answer:
        return json.load(answer)


def times(frames):
    return [(frame["time_ticks"], frame["start_ticks"], frame["end_ticks"], frame["bound_by"]) for frame in frames]


def check_prediction(scene, cluster_sizes, *arguments, questions=((),)):
    """Records one run, and asks for every cluster, with the options of every question besides."""
    with Folder() as folder:
        folder.render(scene, *IN_PROCESS, *arguments, "--record", folder.file("run.rec"))
        for r, s, *more in [(*size, *question) for size in cluster_sizes for question in questions]:
            live = folder.render(scene, *IN_PROCESS, *arguments, "-r", r, "-s", s, *more)
            combination = analyse(folder, "predict", folder.file("run.rec"), "-r", r, "-s", s, *more)["combinations"][0]
            assert times(combination["frames"]) == times(live["frames"]), "%d + %d nodes %s: %s, live %s" % (
                r, s, more, times(combination["frames"]), times(live["frames"]))
            for predicted, frame in zip(combination["frames"], live["frames"]):
                assert predicted["composition_bytes"] == frame["composition"]["bytes"]["total"]
                assert predicted["composition_sent_bytes"] == frame["composition"]["sent_bytes"]
                assert predicted["geometry_bytes"] == frame["geometry"]["bytes"]["total"]
                assert predicted["raster_busy_ps"] == max(frame["raster_busy_ps"])
                assert predicted["shading_busy_ps"] == max(frame["shading_busy_ps"])


def test_a_prediction_is_what_a_live_run_says():
    sizes = [(7, 4), (13, 2)] if SANITIZED else [(1, 1), (2, 3), (7, 4), (13, 2)]
    check_prediction(BOWLING, sizes, "--format", "480x256")
    check_prediction(SOLID, [(7, 4)] if SANITIZED else sizes[1:3], "--format", "320x200")
    check_prediction(COINCIDENT, sizes, "--format", "300x200")


def test_a_prediction_is_what_a_live_run_says_whatever_the_strategy():
    check_prediction(BOWLING, [(6, 3)], "--format", "120x100",
                     questions=[("--composition", name) for name in ("direct-send", "binary-swap", "radix-k", "tree")])


def test_a_prediction_is_what_a_live_run_says_with_other_options():
    check_prediction(BOWLING, [(3, 2)], "--format", "320x200", "--math", "fast", "--frames", "3")
    check_prediction(COINCIDENT, [(3, 2)], "--samples", "4")
    with Folder() as folder:
        folder.render(BOWLING, *IN_PROCESS, "--format", "320x200", "--record", folder.file("run.rec"))
        live = folder.render(BOWLING, *IN_PROCESS, "--format", "320x200", "-r", 4, "--seed", 77)
        answer = analyse(folder, "predict", folder.file("run.rec"), "-r", 4, "--seed", 77)
        assert times(answer["combinations"][0]["frames"]) == times(live["frames"])


def test_a_prediction_of_other_chunks_is_what_a_live_run_says():
    """Longer chunks have fewer vertices, are dealt otherwise, and end where a mesh does or a triangle is left out."""
    for scene in (BOWLING, SOLID):
        check_prediction(scene, [(5, 2)], "--format", "120x100", "--chunk-triangles", 32,
                         questions=[("--chunk-triangles", triangles) for triangles in (96, 21824)])
    with Folder() as folder:
        small = (BOWLING, "--format", "120x100", "-r", 3)
        answers = analyse(folder, "predict", *small, "--chunk-triangles", "48,80")["combinations"]
        for triangles, answer in zip((48, 80), answers):
            live = folder.render(*small, *IN_PROCESS, "--chunk-triangles", triangles)
            assert times(answer["frames"]) == times(live["frames"])
        folder.render(*small, *IN_PROCESS, "--record", folder.file("run.rec"))
        code, out, err = folder.run("predict", folder.file("run.rec"), "--chunk-triangles", 300)
        assert code == 1 and "chunks of 256 triangles" in err and "--chunk-triangles 300" in err, (code, err)


def test_regions_assigned_by_cost_are_what_was_predicted():
    with Folder() as folder:
        options = (BOWLING, "--format", "400x200", "--compression", "none", "-o", folder.file("p.exr"))
        folder.render(*options, *IN_PROCESS, "--frames", 2, "--record", folder.file("run.rec"))
        with open(folder.file("run.rec"), "rb") as record:
            recorded = record.read()
        turn = folder.render(*options, *IN_PROCESS, "-r", 3, "-s", 4, "-o", folder.file("turn.exr"))
        by_cost = ("--assignment", "by-cost", "--costs-from", folder.file("run.rec"))
        for strategy, more in (("chain", IN_PROCESS), ("binary-swap", ())):
            cluster = ("-r", 3, "-s", 4, "--composition", strategy)
            answer = analyse(folder, "predict", folder.file("run.rec"), *cluster, "--assignment", "by-cost")["combinations"][0]
            live = folder.render(*options, *cluster, *more, *by_cost, "--frames", 2, "-o", folder.file("p.%04d.exr"), "--record",
                                 folder.file("again.rec"), "--explain-time")
            assert times(answer["frames"]) == times(live["frames"]), (strategy, more)
            assert live["assignment"] == "by-cost"
            for predicted, frame in zip(answer["frames"], live["frames"]):
                assert predicted["geometry_bytes"] == frame["geometry"]["bytes"]["total"]
                assert predicted["shading_busy_ps"] == max(frame["shading_busy_ps"])
                assert sum(step["duration_ticks"] for step in frame["critical_path"]) == frame["time_ticks"]
            folder.assert_same_picture(folder.file("turn.exr"), folder.file("p.0001.exr"))
            with open(folder.file("again.rec"), "rb") as record:
                assert record.read() == recorded  # who shades what is no part of it
            if strategy == "chain":  # better balanced, at two bytes a region
                assert max(live["frames"][0]["shading_busy_ps"]) < max(turn["frames"][0]["shading_busy_ps"])
                assert live["frames"][0]["geometry"]["bytes"]["control"] == turn["frames"][0]["geometry"]["bytes"]["control"] + 2 * 16
        for arguments, words in (((*by_cost[:2],), ("--costs-from",)), ((*by_cost[2:],), ("--assignment",)),
                                 ((*by_cost, "--format", "64x64"), ("16 regions", "here are 1")),
                                 ((*by_cost[:3], "none.rec"), ("none.rec",))):
            code, out, err = folder.run("render", *options, *IN_PROCESS, *arguments)
            assert code == 1 and all(word in err for word in words), (arguments, code, err)


def test_a_record_is_the_same_on_every_cluster():
    with Folder() as folder:
        records = []
        for number, cluster in enumerate([IN_PROCESS, (*IN_PROCESS, "-r", 5, "-s", 3, "--schedule-seed", 9),
                                          ("-r", 2, "-s", 2), ("-r", 3, "-s", 1, "--transport", "tcp")]):
            name = folder.file("run%d.rec" % number)
            folder.render(SOLID, "--format", "320x200", *cluster, "--record", name)
            with open(name, "rb") as record:
                records.append(record.read())
        assert len(set(records)) == 1, [len(record) for record in records]


def test_a_scene_is_recorded_on_the_way():
    with Folder() as folder:
        live = folder.render(COINCIDENT, *IN_PROCESS, "-r", 3, "-s", 2, "--format", "200x200")
        answer = analyse(folder, "predict", COINCIDENT, "-r", 3, "-s", 2, "--format", "200x200")
        assert times(answer["combinations"][0]["frames"]) == times(live["frames"])


def test_reasons_and_critical_path_add_up_to_the_frame_time():
    with Folder() as folder:
        folder.render(SOLID, *IN_PROCESS, "--format", "320x200", "--record", folder.file("run.rec"))
        answer = analyse(folder, "predict", folder.file("run.rec"), "-r", 3, "-s", 2, "--explain")
        for frame in answer["combinations"][0]["frames"]:
            assert sum(step["duration_ticks"] for step in frame["critical_path"]) == frame["time_ticks"]
            assert len(frame["resources"]) == 3 + 3 + 2
            for resource in frame["resources"]:
                assert resource["busy_ticks"] + sum(resource["idle_ticks"].values()) == frame["time_ticks"], resource
        for strategy in ("chain", "direct-send"):
            question = ("-r", 3, "-s", 2, "--composition", strategy)
            answer = analyse(folder, "predict", folder.file("run.rec"), *question, "--explain")
            live = folder.render(SOLID, *IN_PROCESS, "--format", "320x200", *question, "--explain-time")
            for frame, predicted in zip(live["frames"], answer["combinations"][0]["frames"]):
                assert frame["critical_path"] == predicted["critical_path"]
                assert frame["resources"] == predicted["resources"]


def test_every_combination_is_answered_alike_in_json_and_csv():
    with Folder() as folder:
        folder.render(BOWLING, *IN_PROCESS, "--format", "320x200", "--record", folder.file("run.rec"))
        answer = analyse(folder, "predict", folder.file("run.rec"), "-r", "1..4", "-s", "1,2,8", "--region-buffers", "1..2",
                         "--maps", "specific,union", "--assignment", "round-robin,by-cost", "--csv", folder.file("t.csv"))
        combinations = answer["combinations"]
        assert len(combinations) == 4 * 3 * 2 * 2 * 2
        with open(folder.file("t.csv"), newline="") as table:
            rows = list(csv.DictReader(table))
        assert len(rows) == len(combinations)
        for row, combination in zip(rows, combinations):
            assert int(row["time_ticks"]) == combination["frames"][0]["time_ticks"]
            for key in ("rendering_nodes", "shading_nodes", "maps", "assignment", "composition_region_buffers", "bound_by"):
                assert row[key] == str(combination[key]), (key, row, combination)
        by = {tuple(c[k] for k in ("rendering_nodes", "shading_nodes", "maps", "assignment", "composition_region_buffers")):
              c["end_ticks"] for c in combinations}
        for (r, s, maps, assignment, buffers), end in by.items():
            assert buffers == 1 or end <= by[r, s, maps, assignment, 1]
            assert maps == "specific" or end >= by[r, s, "specific", assignment, buffers]


def test_a_prediction_holds_at_the_edges_of_sizes():
    """A machine that takes a while to begin shading, regions of 8x8 and 512x512 samples, a picture of one pixel, a shader of 999 parameters on a polygon that has P besides: the
    most a request may have."""
    with Folder() as folder:
        with open(os.path.join(SOURCE, "machines", "pixelflow.json")) as text:
            machine = json.load(text)
        for width, height, side in ((1, 1, 8), (150, 90, 8), (150, 90, 512), (1, 300, 512)):
            machine["parameters"]["region_width"]["value"] = machine["parameters"]["region_height"]["value"] = side
            machine["parameters"]["shading_region_ps"]["value"] = 7000000
            path = folder.write("m%d.json" % side, json.dumps(machine))
            options = (BOWLING, *IN_PROCESS, "--format", "%dx%d" % (width, height), "--machine", path)
            live = folder.render(*options, "-r", 3, "-s", 2, "--record", folder.file("edge.rec"))
            answer = analyse(folder, "predict", folder.file("edge.rec"), "-r", 3, "-s", 2)
            assert times(answer["combinations"][0]["frames"]) == times(live["frames"]), (width, height, side)
            free = analyse(folder, "predict", folder.file("edge.rec"), "-r", 3, "-s", 1, "--shading-region-ps", "0,7000000")
            busy = [c["frames"][0]["shading_busy_ps"] for c in free["combinations"]]
            assert busy[1] - busy[0] == 7000000 * live["frames"][0]["regions_covered"]
        names = ["p%d" % i for i in range(999)]
        folder.write("many.sl", "surface many(%s) { Ci = %s; Oi = 1; }\n" % (
            "; ".join("varying float %s = 0" % name for name in names), " + ".join(names)))
        scene = folder.write("many.rib", WIDE_SCENE.replace('"wide"', '"many"') % (
            "", " ".join('"varying float %s" [0 0 1 1]' % name for name in names)))
        live = folder.render(scene, *IN_PROCESS, "-r", 2, "-s", 2, "--record", folder.file("many.rec"))
        answer = analyse(folder, "predict", folder.file("many.rec"), "-r", 2, "-s", 2)
        assert times(answer["combinations"][0]["frames"]) == times(live["frames"])
        assert live["frames"][0]["composition"]["bytes"]["total"] == 4 * 8192 * 32 * 143  # ceil(3998 / 28) words
        budget = analyse(folder, "budget", folder.file("many.rec"), "-s", 2)
        assert (budget["instances"][0]["map_bytes"], budget["instances"][0]["words"]) == (3998, 143)
        assert len(budget["instances"][0]["parameters"]) == 999


def test_extremes_are_answered_or_refused_in_words():
    with Folder() as folder:
        folder.render(BOWLING, *IN_PROCESS, "--format", "320x200", "--record", folder.file("run.rec"))
        for arguments in (("-r", "16384", "-s", "16384"), ("--composition-bytes-per-s", "1,1000T"),
                          ("--hop-latency-ps", "0,1T"), ("--geometry-bytes-per-s", "1,1000T"),
                          ("--set", "raster_triangle_ps=0,1T", "--region-buffers", "1024")):
            answer = analyse(folder, "predict", folder.file("run.rec"), *arguments)
            assert all(c["end_ticks"] > 0 for c in answer["combinations"])
        code, out, err = folder.run("predict", folder.file("run.rec"), "--set", "raster_triangle_ps=999999999999",
                                    "--composition-bytes-per-s", "999999937", "--geometry-bytes-per-s", "999999929")
        assert code == 1 and "ticks" in err, (code, err)
        empty = folder.write("empty.rib", "Format 1 1 1\nWorldBegin\nWorldEnd\n")
        answer = analyse(folder, "predict", empty, "-r", 3, "-s", 2)
        assert answer["combinations"][0]["frames"][0]["composition_bytes"] == 32


def test_bad_input_is_named():
    with Folder() as folder:
        folder.render(COINCIDENT, *IN_PROCESS, "--format", "64x64", "--record", folder.file("run.rec"))
        with open(folder.file("run.rec"), "rb") as record:
            data = bytearray(record.read())
        data[len(data) // 2] ^= 1
        with open(folder.file("bad.rec"), "wb") as record:
            record.write(data)
        for arguments, words in ((("bad.rec",), ("bad.rec", "damaged")), (("none.rec",), ("none.rec",)),
                                 (("run.rec", "--set", "nonsense=1"), ("--set",)),
                                 (("run.rec", "-r", "0"), ("rendering_nodes",)),
                                 (("run.rec", "-r", "1..x"), ("rendering_nodes",)),
                                 (("run.rec", "--maps", "some"), ("maps", "some")),
                                 (("run.rec", "--frobnicate"), ("--frobnicate",)),
                                 (("run.rec", "--format", "3x3"), ("--format", "record")),
                                 (("run.rec", "--region-width", "64"), ("regions",))):
            code, out, err = folder.run("predict", *arguments)
            assert code == 1 and all(word in err for word in words), (arguments, code, err)


def test_sensitivity_says_what_has_no_effect():
    with Folder() as folder:
        folder.render(BOWLING, *IN_PROCESS, "--format", "320x200", "--record", folder.file("run.rec"))
        answer = analyse(folder, "predict", folder.file("run.rec"), "-r", 2, "-s", 2, "--sensitivity")
        effects = {entry["parameter"]: entry for entry in answer["sensitivity"]}
        code, out, err = folder.run("machine", "show")
        listed = [line.split()[0] for line in out.splitlines()[3:] if line.strip()]
        assert sorted(effects) == sorted(listed), set(effects) ^ set(listed)
        assert effects["float_add_ps"]["higher_change"] > 0 > effects["float_add_ps"]["lower_change"]
        assert effects["texture_memory_bytes"]["higher_change"] == effects["texture_memory_bytes"]["lower_change"] == 0
        assert "not_tried" in effects["region_width"]
        code, out, err = folder.run("predict", folder.file("run.rec"), "--sensitivity")
        assert "no effect here:" in out and "texture_memory_bytes" in out.split("no effect here:")[1]


def test_every_machine_parameter_is_explained():
    """Unit, value and source stand in the table of `machine show`; where it enters and what it does, in docs/timing.md."""
    with Folder() as folder, open(os.path.join(SOURCE, "docs", "timing.md")) as page:
        explained = page.read()
        code, out, err = folder.run("machine", "show")
        rows = [line.split() for line in out.splitlines()[3:] if line.strip()]
        assert len(rows) > 40 and all(row[1].isdigit() and row[2] for row in rows)
        prices = [row[0] for row in rows].index("float_add_ps")
        missing = [row[0] for row in rows[:prices] if "`%s`" % row[0] not in explained]
        assert not missing, missing


def test_the_budget_has_the_arithmetic_of_the_paper():
    with Folder() as folder:
        folder.render(BOWLING, *IN_PROCESS, "--record", folder.file("run.rec"))
        budget = analyse(folder, "budget", folder.file("run.rec"), "-s", 4)
        assert budget["effective_bytes_per_s"] == 5600000000
        assert "%.1f" % budget["budget_bytes_per_sample"] == "142.4"
        assert budget["usable_bytes_per_sample"] == 140
        assert budget["regions"] == 160
        assert budget["shading_time_per_region_ps"] == 825000000
        assert analyse(folder, "budget", folder.file("run.rec"), "-s", 16)["shading_time_per_region_ps"] == 3300000000
        assert [i["name"] for i in budget["instances"]][0] == "fancy_brick"
        brick = budget["instances"][0]
        assert (brick["map_bytes"], brick["words"], brick["meets"]) == (46, 2, True)
        assert analyse(folder, "budget", folder.file("run.rec"), "--fps", 120)["usable_bytes_per_sample"] == 28


def test_suggestions_are_what_the_changes_bring():
    with Folder() as folder:
        folder.render(BOWLING, *IN_PROCESS, "--format", "640x384", "--record", folder.file("run.rec"))
        budget = analyse(folder, "budget", folder.file("run.rec"), "-r", 2, "-s", 2, "--fps", 60)
        assert not budget["meets"] and budget["suggestions"]
        met = [s for s in budget["suggestions"] if s["meets"]]
        assert met and budget["suggestions"][0] in met and met[0]["time_ps"] * 60 <= 10**12
        for suggestion in budget["suggestions"]:
            arguments = {"-r": 2, "-s": 2}
            for part in suggestion["change"].split(", "):
                words = part.split()
                if part.endswith("shading nodes instead of 2"):
                    arguments["-s"] = words[0]
                elif part.endswith("rendering nodes instead of 2"):
                    arguments["-r"] = words[0]
                elif part.endswith("region buffers a node instead of 2"):
                    arguments["--region-buffers"] = words[0]
                elif part == "fast versions of the mathematical functions":
                    arguments["--math"] = "fast"
                elif part == "regions to shading nodes by cost":
                    arguments["--assignment"] = "by-cost"
                else:
                    assert words[0] in ("composition", "geometry") and words[1] == "at", part
                    arguments["--%s-bytes-per-s" % words[0]] = words[2] + "G"
            answer = analyse(folder, "predict", folder.file("run.rec"), *[a for pair in arguments.items() for a in pair])
            assert answer["combinations"][0]["time_ps"] == suggestion["time_ps"], suggestion
        assert len(budget["suggestions"]) >= 6
        # best first: what meets the target with least, then what helps, by time
        order = [(not s["meets"], 0 if s["meets"] else s["time_ps"]) for s in budget["suggestions"]]
        assert order == sorted(order)


def test_binding_a_parameter_brings_what_the_budget_says():
    """A map of 30 bytes takes two words; without one of its floats, one."""
    values = ['"varying float %s" [0 0.25 0.5 1]' % name for name in NAMES]
    with Folder() as folder:
        folder.write("wide.sl", WIDE)
        scene = folder.write("wide.rib", WIDE_SCENE % ("", " ".join(values)))
        bound = folder.write("bound.rib", WIDE_SCENE % ('"roughness" 0.5', " ".join(values[1:])))
        budget = analyse(folder, "budget", scene, "--fps", 100000)
        found = [s for s in budget["suggestions"] if "`roughness`" in s["change"]]
        live = folder.render(bound, *IN_PROCESS)["frames"][0]["time_ps"]
        before = folder.render(scene, *IN_PROCESS)["frames"][0]["time_ps"]
        assert len(found) == 1 and found[0]["time_ps"] == live < before, (found, live, before)
        assert found[0]["change"] == "bind `roughness` in 1 instance: 56 -> 28 bytes", found[0]["change"]


def test_output_to_a_pipe_has_no_escapes():
    with Folder() as folder:
        folder.render(BOWLING, *IN_PROCESS, "--format", "320x200", "--record", folder.file("run.rec"))
        for verb in ("budget", "predict"):
            code, out, err = folder.run(verb, folder.file("run.rec"))
            assert code == 0 and "\033" not in out and out, (verb, code, err)


def test_the_timeline_opens_and_adds_up():
    with Folder() as folder:
        folder.render(SOLID, *IN_PROCESS, "--format", "320x200", "--record", folder.file("run.rec"))
        answer = analyse(folder, "predict", folder.file("run.rec"), "-r", 3, "-s", 2, "--explain")["combinations"][0]
        code, out, err = folder.run("trace", folder.file("run.rec"), "-r", 3, "-s", 2, "-o", folder.file("t.json"))
        assert code == 0, err
        with open(folder.file("t.json")) as text:
            trace = json.load(text, parse_float=lambda digits: int(digits.replace(".", "")))  # microseconds to picoseconds
        spans = [event for event in trace["traceEvents"] if event["ph"] == "X"]
        assert max(event["ts"] + event["dur"] for event in spans) == answer["end_ps"]
        busy = sum(event["dur"] for event in spans if event["cat"] == "transfer")
        assert busy == sum(frame["composition_busy_ps"] for frame in answer["frames"])
        rows = {}
        for event in spans:
            rows.setdefault((event["pid"], event["tid"]), []).append((event["ts"], event["ts"] + event["dur"]))
        assert len(rows) == 3 + 3 + 2
        for row in rows.values():
            row.sort()
            assert all(a[1] <= b[0] for a, b in zip(row, row[1:])), "activities of one resource overlap"
        buffers = [event["args"]["regions"] for event in trace["traceEvents"] if event["ph"] == "C"]
        assert buffers and min(buffers) == 0 and max(buffers) <= 2
        code, out, err = folder.run("trace", folder.file("run.rec"), "-r", 3, "-s", 2, "-o", folder.file("t.svg"))
        assert code == 0, err
        chart = xml.dom.minidom.parse(folder.file("t.svg"))
        assert len(chart.getElementsByTagName("rect")) > len(spans)


if __name__ == "__main__":
    main(globals())
