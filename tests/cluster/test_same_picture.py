# SPDX-License-Identifier: Apache-2.0
"""Contracts C1 and C2: the picture does not depend on node counts, driver or transport, and simulated time is the
same wherever the same cluster is simulated."""

import math
import os
import random

from harness import SANITIZED, SCENES, Folder, main

# what is equal is shown by the release build; under sanitizers the same ways are gone, with fewer clusters
NODES = [(1, 1), (5, 4)] if SANITIZED else [(1, 1), (2, 3), (5, 4), (8, 8)]
SMALL = ["--format", "192x160" if SANITIZED else "320x256", "--chord", "0.5", "--compression", "none"]


def scenes():
    for name in ("bowling", "bricks", "solid", "mandelbrot", "coincident"):
        yield name, os.path.join(SCENES, name, name + ".rib")


def times(summary):
    return [(f["time_ps"], f["start_ps"], f["end_ps"], f["composition"], f["geometry"], f["raster_busy_ps"],
             f["shading_busy_ps"], f["bound_by"]) for f in summary["frames"]]


def pictures(summary):
    return [frame["image"] for frame in summary["frames"]]


def check_runs(folder, scene, runs):
    """runs: (name, nodes, arguments). All pictures equal; equal node counts take equal time."""
    reference, time_of = None, {}
    for name, nodes, arguments in runs:
        summary = folder.render(scene, "-r", nodes[0], "-s", nodes[1], "-o", folder.file(name + ".exr"), *SMALL,
                                *arguments)
        if reference is None:
            reference = pictures(summary)
        for a, b in zip(reference, pictures(summary)):
            folder.assert_same_picture(a, b)
        assert len(pictures(summary)) == len(reference)
        assert time_of.setdefault(nodes, times(summary)) == times(summary), "%s: other times" % name


def test_node_counts_drivers_and_transports_give_the_same_picture():
    for name, scene in scenes():
        runs = []
        for r, s in NODES:
            runs.append(("in-process-%d-%d" % (r, s), (r, s), ["--driver", "in-process"]))
            runs.append(("processes-%d-%d" % (r, s), (r, s), ["--driver", "processes"]))
        runs.append(("tcp", (2, 3), ["--transport", "tcp"]))
        with Folder() as folder:
            check_runs(folder, scene, runs)


STRATEGIES = ("direct-send", "binary-swap", "radix-k", "tree")


def test_every_composition_strategy_gives_the_same_picture():
    for name, scene in scenes():
        with Folder() as folder:
            whole, first, time_of = None, None, {}
            runs = [("chain", 1, 1, "in-process", 0)]
            for strategy in STRATEGIES:
                runs += [(strategy, 7, 2, "in-process", 9)] + ([] if SANITIZED else [(strategy, 4, 3, "in-process", 5)])
                if name == "coincident":
                    runs += [(strategy, 7, 2, "processes", 0), (strategy, 13, 1, "processes", 0)]
            for strategy, r, s, driver, seed in runs:
                out = folder.file("%s-%d-%s.exr" % (strategy, r, driver))
                summary = folder.render(scene, "-r", r, "-s", s, "--composition", strategy, "--driver", driver, "-o",
                                        out, *SMALL, *(["--schedule-seed", seed] if seed else []))
                assert summary["composition_strategy"] == strategy
                first = first or pictures(summary)
                for a, b in zip(first, pictures(summary)):
                    folder.assert_same_picture(a, b)
                assert time_of.setdefault((strategy, r, s), times(summary)) == times(summary), (strategy, r, s)
                for frame in summary["frames"]:  # every byte has a cause, whatever way it came
                    parts = frame["composition"]["bytes"]
                    assert sum(v for k, v in parts.items() if k != "total") == parts["total"]
                # what a region says when it is composed does not depend on the way, unless the shading node composes
                said = [[f["composition"]["bytes"][k] for k in ("shader_id", "parameters")] for f in summary["frames"]]
                whole = whole or said
                assert said == whole or (strategy == "direct-send" and all(
                    a >= b for one, other in zip(said, whole) for a, b in zip(one, other))), (strategy, r, said, whole)


def test_any_order_of_events_gives_the_same_picture_and_time():
    for name, scene in scenes():
        with Folder() as folder:
            check_runs(folder, scene, [("schedule-%d" % seed, (3, 2), ["--driver", "in-process", "--schedule-seed", seed])
                                       for seed in range(2 if SANITIZED else 5)])


def test_another_distribution_of_primitives_gives_the_same_picture():
    for name, scene in scenes():
        with Folder() as folder:
            first = None
            for seed in (1, 99) if SANITIZED else (1, 2, 99):
                summary = folder.render(scene, "-r", 4, "-s", 2, "--driver", "in-process", "--seed", seed, "-o",
                                        folder.file("seed-%d.exr" % seed), *SMALL)
                first = first or pictures(summary)
                for a, b in zip(first, pictures(summary)):
                    folder.assert_same_picture(a, b)


def hostile_scenes():
    """Needles, and large planes seen nearly edge-on, where the distances of a ray tracer are least certain."""
    draw = random.Random(7)
    header = 'Format 350 250 1\n%s\nWorldBegin\nSurface "constant"\n'
    perspective, orthographic = 'Projection "perspective" "fov" [60]', 'Projection "orthographic"'

    def polygon(points):
        return "Color [%.3f %.3f %.3f]\nPolygon \"P\" [%s]\n" % (draw.random(), draw.random(), draw.random(),
                                                              " ".join("%.9g" % x for p in points for x in p))
    needles = ""
    for i in range(1500):
        x, y, z, angle = draw.uniform(-3, 3), draw.uniform(-2, 2), draw.uniform(3, 5), draw.uniform(0, 6.3)
        dx, dy, thin = 4 * math.cos(angle), 4 * math.sin(angle), 10 ** draw.uniform(-7, -2)
        needles += polygon([(x - dx, y - dy, z), (x + dx, y + dy, z + draw.uniform(-1, 1)), (x + thin, y + thin, z)])
    yield "needles", header % perspective + needles + "WorldEnd\n"
    for name, size, distance in (("near", 1e5, 0.05), ("far", 1e6, 1)):
        planes = ""
        for i in range(24):
            a, tilt = draw.uniform(0, 6.3), draw.uniform(-1e-3, 1e-3)
            u, v = (math.cos(a), math.sin(a) * 0.2, 1), (-math.sin(a), math.cos(a) * 0.2, 1 + tilt)
            o = (0, -distance * (1 + i * 1e-4), 0)
            planes += polygon([tuple(o[k] + size * (p * u[k] + q * v[k]) * (0.01 if k == 1 else 1) for k in range(3))
                               for p, q in ((-1, -1), (1, -1), (1, 1), (-1, 1))])
        yield name, header % perspective + planes + "WorldEnd\n"
    steep = ""
    for i in range(40):
        x, slope = draw.uniform(-1, 1), 10 ** draw.uniform(2, 5) * draw.choice((-1, 1))
        steep += polygon([(x - 0.5, -1, 3000 - 0.5 * slope), (x + 0.5, -1, 3000 + 0.5 * slope),
                          (x + 0.5, 1, 3000 + 0.5 * slope), (x - 0.5, 1, 3000 - 0.5 * slope)])
    yield "steep", header % orthographic + steep + "WorldEnd\n"


def test_geometry_at_the_edge_of_precision_gives_the_same_picture():
    for name, text in hostile_scenes():
        with Folder() as folder:
            scene, first = folder.write(name + ".rib", text), None
            clusters = ((1, 1, 1), (3, 2, 1), (8, 8, 9), (24, 1, 1), (64, 3, 4))
            for r, s, seed in clusters[::2] if SANITIZED else clusters:
                out = folder.file("%s-%d.exr" % (name, r))
                summary = folder.render(scene, "-r", r, "-s", s, "--seed", seed, "--driver", "in-process", "-o", out,
                                        "--compression", "none")
                assert summary["frames"][0]["samples_covered"] > 10000, summary["frames"][0]["samples_covered"]
                first = first or out
                folder.assert_same_picture(first, out)


def test_vector_width_does_not_change_a_bit():
    widths = {"4": None, "8": "avx2", "16": "avx512vl"}
    flags = open("/proc/cpuinfo").read()
    name, scene = next(scenes())
    with Folder() as folder:
        first = None
        for width, flag in widths.items():
            if flag and flag not in flags:
                continue
            os.environ["SORTLAST_VECTOR_WIDTH"] = width
            try:
                summary = folder.render(scene, "--driver", "in-process", "-o", folder.file("w%s.exr" % width), *SMALL)
            finally:
                del os.environ["SORTLAST_VECTOR_WIDTH"]
            first = first or pictures(summary)
            for a, b in zip(first, pictures(summary)):
                folder.assert_same_picture(a, b)


if __name__ == "__main__":
    main(globals())
