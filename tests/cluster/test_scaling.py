# SPDX-License-Identifier: Apache-2.0
"""`sortlast scale`: predictions and live runs take the same simulated time, to the tick; a scene that shading bounds
scales until composition bounds it, where arithmetic says; a study goes on where it was interrupted."""

import csv
import json
import os
import shutil

from harness import SCENES, Folder, main

BOWLING = os.path.join(SCENES, "bowling", "bowling.rib")
# one surface over the whole picture: every region costs the same
WALL = os.path.join(SCENES, "wall", "wall.rib")


def scale(folder, scene, *arguments, status=0):
    code, out, err = folder.run("scale", scene, "-q", "--json", folder.file("scale.json"), *arguments)
    assert code == status, (code, err)
    if status:
        return err
    with open(folder.file("scale.json")) as result:
        return json.load(result)


def test_live_runs_take_the_predicted_time():
    with Folder() as folder:
        for more in ([], ["--composition", "radix-k"], ["--machine", "ethernet-100g", "--composition", "direct-send"]):
            study = scale(folder, BOWLING, "-r", "1,3", "-s", "1,2", "--format", "320x256", "--live", 7, *more)
            assert len(study["points"]) == 4
            for point in study["points"]:
                assert point["live_time_ticks"] == point["time_ticks"], point
        folder.assert_nothing_left()


def test_sixteen_shading_nodes_are_worth_95_percent_of_sixteen():
    with Folder() as folder:
        study = scale(folder, WALL, "-r", 1, "-s", "1,16", "--frames", 4, "--live", 19)
        one, sixteen = study["points"]
        for point in study["points"]:
            assert point["bound_by"] == "shading" and point["live_time_ticks"] == point["time_ticks"], point
        assert sixteen["efficiency"] >= 0.95, sixteen
        assert abs(sixteen["speed_up"] - one["time_ticks"] / sixteen["time_ticks"]) < 1e-9
        assert abs(sixteen["efficiency"] - sixteen["speed_up"] / 16) < 1e-9


def test_composition_takes_over_where_arithmetic_says():
    with Folder() as folder:
        frame = folder.render(WALL, "--driver", "in-process")["frames"][0]
        regions, shading = frame["regions"], frame["shading_busy_ps"][0]
        composition = frame["composition"]["busy_ps"]
        assert regions == 160 and frame["regions_covered"] == 160 and composition == 160 * 8192 * 5000
        # the busiest of s nodes shades ceil(160 / s) regions, all alike; composition is busy for all of them
        expected = min(s for s in range(1, 161) if -(-regions // s) * shading < composition * regions)
        study = scale(folder, WALL, "-r", "1,4", "-s", "1..40", "--live", 0)
        assert [c["shading_nodes"] for c in study["crossovers"]] == [expected, expected], (study["crossovers"], expected)
        for point in study["points"]:
            assert (point["bound_by"] == "shading") == (point["shading_nodes"] < expected), point
            assert "live_time_ticks" not in point
        last = study["points"][39]  # nothing left to gain: the time of composition, filling and draining
        assert composition < last["time_ps"] < 1.2 * composition, last


def test_a_grown_picture_keeps_each_node_as_busy():
    with Folder() as folder:
        study = scale(folder, WALL, "--weak", "-r", 1, "-s", "1,4,16", "--format", "512x256", "--live", 0)
        assert [point["regions"] for point in study["points"]] == [16, 64, 256], study["points"]
        assert study["scaling"] == "weak"
        for point in study["points"]:
            assert 0.85 < point["efficiency"] <= 1, point


def test_a_study_goes_on_where_it_was_interrupted():
    with Folder() as folder:
        arguments = ["-r", "1,2", "-s", "1,2", "--format", "160x128", "--live", 6, "--state", folder.file("state")]
        whole = scale(folder, BOWLING, *arguments)
        with open(folder.file("state")) as state:
            lines = state.read().splitlines(keepends=True)
        assert len(lines) == 5
        with open(folder.file("state"), "w") as state:  # two runs done, the third being written
            state.write("".join(lines[:3]) + lines[3][:4])
        again = scale(folder, BOWLING, *arguments)
        for before, after in zip(whole["points"], again["points"]):
            assert before["live_time_ticks"] == after["live_time_ticks"]
        assert [p["live_wall_s"] for p in whole["points"][:2]] == [p["live_wall_s"] for p in again["points"][:2]]
        with open(folder.file("state")) as state:
            assert len(state.read().splitlines()) == 5
        refused = scale(folder, BOWLING, *arguments, "--composition", "tree", status=1)
        assert "not the state of this study" in refused, refused


def test_table_csv_and_plot_say_the_same():
    with Folder() as folder:
        code, out, err = folder.run("scale", BOWLING, "-r", "1..2", "-s", "1..4", "--format", "160x128", "--live", 0,
                                    "--csv", folder.file("s.csv"), "--json", folder.file("s.json"), "--plot",
                                    folder.file("plot"))
        assert code == 0, err
        with open(folder.file("s.json")) as text:
            points = json.load(text)["points"]
        with open(folder.file("s.csv")) as text:
            rows = list(csv.DictReader(text))
        assert len(rows) == len(points) == 8
        for row, point in zip(rows, points):
            assert int(row["time_ticks"]) == point["time_ticks"] and row["bound_by"] == point["bound_by"]
            assert "%.6f" % (1e3 * point["time_ticks"] / point["ticks_per_s"]) in out
        if shutil.which("gnuplot"):
            with open(folder.file("plot.svg")) as picture:
                assert "</svg>" in picture.read()
        else:
            assert "gnuplot is not there" in err and os.path.exists(folder.file("plot.gp"))


def test_what_cannot_be_is_refused():
    with Folder() as folder:
        for arguments in (["-r", "0"], ["-s", "x"], ["--live", "129"], ["--assignment", "by-cost"], ["--composition", "star"], ["--nonsense", "1"],
                          ["--state"], [BOWLING]):
            err = scale(folder, BOWLING, *arguments, status=1)
            assert err.startswith("sortlast: "), err
        folder.run("render", BOWLING, "-q", "--format", "160x128", "--record", folder.file("run.rec"))
        err = scale(folder, folder.file("run.rec"), "--weak", status=1)
        assert "needs the scene" in err, err


if __name__ == "__main__":
    main(globals())
