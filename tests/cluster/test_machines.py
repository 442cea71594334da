# SPDX-License-Identifier: Apache-2.0
"""Machine descriptions: those that come with the program, clear errors in others, and one measured on this host."""

import glob
import json
import os

from harness import SCENES, SOURCE, Folder, main

MACHINES = sorted(glob.glob(os.path.join(SOURCE, "machines", "*.json")))


def test_every_description_is_good_and_says_where_each_number_comes_from():
    assert len(MACHINES) >= 3
    with Folder() as folder:
        for words in (["--help"], ["calibrate", "--help"], ["show", "-h"]):
            code, out, err = folder.run("machine", *words)
            assert code == 0 and out.startswith("usage: sortlast machine") and not err, (words, code, out, err)
        code, out, err = folder.run("machine", "list")
        for path in MACHINES:
            name = os.path.basename(path)[:-5]
            assert name in out.split(), out
            code, text, err = folder.run("machine", "check", path)
            assert code == 0 and not text and not err, (path, err)
            with open(path) as file:
                for key, entry in json.load(file)["parameters"].items():
                    assert entry["source"].split(":")[0].split()[0] in ("published", "derived", "ours"), (path, key)
            code, shown, err = folder.run("machine", "show", name)
            assert code == 0 and "composition_bytes_per_s" in shown


def test_errors_name_the_file_and_the_entry():
    with open(MACHINES[0]) as file:
        good = json.load(file)
    rate = "composition_bytes_per_s"

    def changed(value):
        machine = json.loads(json.dumps(good))
        machine["parameters"][rate] = value
        return json.dumps(machine)

    without = json.loads(json.dumps(good))
    del without["parameters"][rate]
    more = json.loads(json.dumps(good))
    more["parameters"]["flux"] = {"value": 1, "source": "ours"}
    cases = [(changed({"value": 0, "source": "ours"}), rate), (changed({"value": 1.5, "source": "ours"}), rate),
             (changed({"value": 6}), "source"), (changed({"source": "ours"}), rate), (json.dumps(without), rate),
             (json.dumps(more), "flux"), ("{", "not valid JSON"), ("[]", "parameters"), ("", "not valid JSON"),
             (changed({"value": 10**17, "source": "ours"}), rate)]
    with Folder() as folder:
        for text, word in cases:
            path = folder.write("broken.json", text)
            code, out, err = folder.run("machine", "check", path)
            assert code == 1 and "broken.json" in err and word in err, (text[:80], code, err)


def test_this_host_can_be_measured_and_used():
    with Folder() as folder:
        host = folder.file("host.json")
        with open(os.path.join(SCENES, "wall", "wall.rib")) as wall:
            scene = folder.write("wall.rib", wall.read().replace("Format 1280 1024", "Format 320 256"))
        code, out, err = folder.run("machine", "calibrate", "-o", host, scene)
        assert code == 0, err
        assert "predicted" in out and "measured" in out, out
        assert folder.run("machine", "check", host)[0] == 0
        with open(host) as file:
            parameters = json.load(file)["parameters"]
        measured = [key for key, entry in parameters.items() if entry["source"].startswith("measured")]
        assert len(measured) >= 22, measured
        value = {key: entry["value"] for key, entry in parameters.items()}
        # what no machine has the other way round: functions together, and an addition; a region, and a triangle of it
        functions = [value[name + "_ps"] for name in "float_noise sin cos tan asin acos atan exp log pow".split()]
        assert sum(functions) > value["float_add_ps"] and min(functions) > 0, value
        assert value["raster_region_ps"] > value["raster_triangle_ps"] > 0, value
        summary = folder.render(scene, "--machine", host, "--driver", "in-process")
        assert summary["machine"] == "this host" and summary["frames"][0]["time_ps"] > 0
        folder.assert_nothing_left()


if __name__ == "__main__":
    main(globals())
