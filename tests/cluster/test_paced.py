# SPDX-License-Identifier: Apache-2.0
"""Paced runs: a cluster whose sockets are throttled to SCALE times the machine's bandwidth takes, on the real clock and
times SCALE, the time the model solves. tests/nodes/test_pacer.c shows the same on a virtual clock, to 0.01 %."""

import json
import os
import statistics
import time

from harness import SCENES, SOURCE, Folder, Skipped, main

BOWLING = os.path.join(SCENES, "bowling", "bowling.rib")
RUNS = 5
TOLERANCE = 0.05
WALL_S = (1.2, 4.0)   # a paced frame lasts no less and no more
HEADROOM = 15         # and this many times what the host needs for the same frame unpaced


def wake_up_lag_s():
    """How late this machine wakes a process that sleeps, 9 times of 10."""
    lags = []
    for i in range(200):
        begin = time.monotonic()
        time.sleep(0.001)
        lags.append(time.monotonic() - begin - 0.001)
    return sorted(lags)[180]


def changed_machine(folder, **changes):
    with open(os.path.join(SOURCE, "machines", "pixelflow.json")) as file:
        machine = json.load(file)
    for name, value in changes.items():
        assert name in machine["parameters"]
        machine["parameters"][name]["value"] = value
    return folder.write("machine.json", json.dumps(machine))


def check_paced(folder, *arguments):
    arguments = [*arguments, "--format", "640x512"]
    folder.render(BOWLING, *arguments)  # shaders are compiled now
    begin = time.monotonic()
    solved_s = folder.render(BOWLING, *arguments)["frames"][0]["time_ps"] * 1e-12
    wall_s = max(WALL_S[0], HEADROOM * (time.monotonic() - begin))
    lag = wake_up_lag_s()
    if wall_s > WALL_S[1] or lag > 0.002:
        raise Skipped("this machine is too busy or too slow to pace: a frame takes %.2f s, a wake-up %.1f ms" %
                      (wall_s / HEADROOM, lag * 1000))
    scale = solved_s / wall_s
    errors = []
    for run in range(RUNS):
        pace = folder.render(BOWLING, *arguments, "--pace", "%.9g" % scale)["pace"]
        frame = pace["frames"][0]
        assert abs(pace["scale"] / scale - 1) < 1e-6
        errors.append(frame["scaled_wall_ps"] / frame["time_ps"] - 1)
    print("        scale %.5f: %s, median %+.2f %%" % (scale, " ".join("%+.2f %%" % (100 * e) for e in errors),
                                                     100 * statistics.median(errors)))
    assert abs(statistics.median(errors)) < TOLERANCE, errors
    folder.assert_nothing_left()


def test_wall_time_times_scale_is_the_solved_time():
    with Folder() as folder:
        check_paced(folder, "-r", 2, "-s", 4)


def test_also_where_the_composition_network_is_the_limit():
    with Folder() as folder:
        machine = changed_machine(folder, composition_bytes_per_s=100000000)
        check_paced(folder, "-r", 3, "-s", 3, "--machine", machine, "--transport", "tcp")


def test_a_paced_picture_is_the_picture():
    with Folder() as folder:
        small = ["--format", "160x128", "--compression", "none"]
        folder.render(BOWLING, "-o", folder.file("free.exr"), *small)
        folder.render(BOWLING, "-o", folder.file("paced.exr"), *small, "-r", 2, "-s", 2, "--pace", 0.1)
        folder.assert_same_picture(folder.file("free.exr"), folder.file("paced.exr"))


def test_a_pace_that_cannot_be_is_refused():
    with Folder() as folder:
        for pace, more in (("0", []), ("-1", []), ("1e9", []), ("x", []), ("nan", []), ("0.1", ["--driver", "in-process"])):
            code, out, err = folder.run("render", BOWLING, "--pace", pace, *more)
            assert code == 1 and "--pace" in err, (pace, code, err)


if __name__ == "__main__":
    main(globals())
