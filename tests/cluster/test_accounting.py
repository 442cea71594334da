# SPDX-License-Identifier: Apache-2.0
"""Contract C3 and the arithmetic of the paper: bytes and busy times of the networks, to the byte and picosecond."""

import re

from harness import Folder, main

CAMERA = """Format %d %d 1
Projection "orthographic"
WorldBegin
"""
REGION_SAMPLES = 128 * 64
WORD_PS = 5000  # 32 bytes at 6.4 GB/s


def map_shader(floats):
    """A surface whose transfer map holds exactly `floats` floats."""
    parameters = "; ".join("varying float p%d = 0" % i for i in range(floats))
    total = " + ".join("p%d" % i for i in range(floats))
    return "surface wide(%s) { Ci = color(%s); Oi = 1; }\n" % (parameters, total or "0.5")


def map_scene(floats, width, height):
    values = " ".join('"varying float p%d" [0 0.25 0.5 1]' % i for i in range(floats))
    return (CAMERA % (width, height) + 'Surface "wide"\nPolygon "P" [-9 -9 1  9 -9 1  9 9 1  -9 9 1] %s\nWorldEnd\n' % values)


def render_map(floats, *arguments, width=1280, height=1024):
    with Folder() as folder:
        folder.write("wide.sl", map_shader(floats))
        scene = folder.write("map.rib", map_scene(floats, width, height))
        return folder.render(scene, "--driver", "in-process", *arguments)


def check_sums(frame):
    for network in ("composition", "geometry"):
        sizes = dict(frame[network]["bytes"])
        total = sizes.pop("total")
        assert sum(sizes.values()) == total, "%s: parts do not add up to %d: %s" % (network, total, sizes)


def test_composition_is_busy_for_the_words_of_the_map():
    for floats in (0, 6, 7, 13, 14, 34, 35):
        payload = 2 + 4 * floats
        words = -(-payload // 28)
        summary = render_map(floats, "-r", 2, "-s", 3)
        frame, instance = summary["frames"][0], summary["instances"][0]
        assert instance["transfer_map_bytes"] == payload
        assert sum(p["bytes"] for p in instance["parameters"]) == 4 * floats
        assert frame["regions"] == frame["regions_covered"] == 160
        assert frame["composition"]["busy_ps"] == 160 * words * REGION_SAMPLES * WORD_PS
        sizes = frame["composition"]["bytes"]
        assert sizes["total"] == 160 * words * REGION_SAMPLES * 32
        assert sizes["depth"] == 160 * words * REGION_SAMPLES * 4
        assert sizes["shader_id"] == 1280 * 1024 * 2
        assert sizes["parameters"] == 1280 * 1024 * 4 * floats
        check_sums(frame)


def test_each_strategy_is_charged_what_it_brings_and_what_it_sends():
    """docs/timing.md: into the shading nodes once, in direct-send from every node; every node sends each region once."""
    region = REGION_SAMPLES * 32 * 2  # a map of 30 bytes: two words
    for strategy in ("chain", "direct-send", "binary-swap", "radix-k", "tree"):
        for r in (1, 4, 6):
            frame = render_map(7, "-r", r, "-s", 2, "--composition", strategy, width=256, height=128)["frames"][0]
            brought = r if strategy == "direct-send" else 1
            assert frame["composition"]["bytes"]["total"] == 4 * region * brought, (strategy, r)
            assert frame["composition"]["sent_bytes"] == 4 * region * r, (strategy, r)
            check_sums(frame)


def test_a_map_of_five_words_bounds_the_frame_rate_at_30_5():
    """PF section 6.2: at most 142 bytes a pixel at 30 frames/s; in whole words 140, which gives 30.5 frames/s."""
    summary = render_map(34, "-r", 2, "-s", 8, "--frames", 4)
    frames = summary["frames"]
    assert [f["bound_by"] for f in frames] == ["composition"] * 4
    assert 1e12 / frames[0]["composition"]["busy_ps"] > 30.5
    assert 1e12 / frames[0]["composition"]["busy_ps"] < 30.52
    # in the steady state nothing but composition is left in the frame time
    assert frames[3]["time_ps"] == frames[3]["composition"]["busy_ps"] == 32768000000
    assert sum(f["time_ps"] for f in frames) == frames[3]["end_ps"]


def test_hop_latency_is_paid_once_a_frame_not_once_a_region():
    """docs/timing.md: the last colours of the one frame arrive r + j hops later and s - j more."""
    near = render_map(6, "-r", 1, "-s", 1)["frames"][0]
    far = render_map(6, "-r", 6, "-s", 1)["frames"][0]
    assert near["composition"]["busy_ps"] == far["composition"]["busy_ps"]
    # the one chunk is on a node of the seed's choice; five more hops of 20 ns lie on the way at most
    assert 0 <= far["end_ps"] - near["end_ps"] <= 5 * 20000


BRICK = """surface brick(%s color brickcolor = color(0.5, 0.1, 0.1); float width = 0.25) {
    float inside = step(0.1, mod(s, width));
    Ci = mix(color(0.4), brickcolor, inside);
    Oi = 1;
}
"""


def render_brick(surface, variable):
    with Folder() as folder:
        folder.write("brick.sl", BRICK % "")
        scene = folder.write("brick.rib", CAMERA % (256, 128) + 'Declare "brickcolor" "color"\nSurface "brick" %s\n'
                             'Polygon "P" [-9 -9 1  9 -9 1  9 9 1  -9 9 1] %s\nWorldEnd\n' % (surface, variable))
        return folder.render(scene, "--driver", "in-process")


def test_a_parameter_moves_from_the_geometry_network_to_the_transfer_map():
    bound = render_brick('"brickcolor" [1 0 0] "uniform float width" [0.5]', "")
    material = render_brick('"uniform float width" [0.5]', '"varying color brickcolor" [1 0 0  0 1 0  0 0 1  1 1 1]')
    b, m = bound["frames"][0], material["frames"][0]
    assert "brickcolor" not in [p["name"] for p in bound["instances"][0]["parameters"]]
    assert "brickcolor" in [p["name"] for p in material["instances"][0]["parameters"]]
    assert m["geometry"]["bytes"]["bound_parameters"] == \
        b["geometry"]["bytes"]["bound_parameters"] - 12
    assert m["composition"]["bytes"]["parameters"] == b["composition"]["bytes"]["parameters"] + 12 * 256 * 128
    # four vertices carry it now, and nothing else moved
    assert m["geometry"]["bytes"]["primitives"] == b["geometry"]["bytes"]["primitives"] + 4 * 12
    for cause in ("shaders", "control"):
        assert m["geometry"]["bytes"][cause] == b["geometry"]["bytes"][cause]
    for cause in ("depth", "shader_id", "total"):
        assert m["composition"]["bytes"][cause] == b["composition"]["bytes"][cause]
    check_sums(b)
    check_sums(m)


def test_an_empty_frame_is_one_word_a_region():
    with Folder() as folder:
        scene = folder.write("empty.rib", CAMERA % (1280, 1024) + "WorldEnd\n")
        frame = folder.render(scene, "--driver", "in-process", "-r", 3, "-s", 2)["frames"][0]
    assert frame["regions_covered"] == 0 and frame["samples_covered"] == 0
    assert frame["composition"]["bytes"]["total"] == 160 * 32
    assert frame["composition"]["busy_ps"] == 160 * WORD_PS
    assert frame["geometry"]["bytes"]["primitives"] == 0
    check_sums(frame)


def test_the_machine_verb_says_where_numbers_come_from():
    with Folder() as folder:
        code, out, err = folder.run("machine", "show")
        assert code == 0 and not err, err
        lines = [line for line in out.splitlines() if "_ps " in line or "_bytes" in line]
        assert len(lines) > 40 and all("published" in l or "ours" in l or "derived" in l for l in lines), out
        assert re.search(r"sin_ps +81360000 +ps .*published: PF table 3", out)
        code, out, err = folder.run("machine", "list")
        assert code == 0 and "pixelflow" in out
        code, out, err = folder.run("machine", "check", folder.write("bad.json", "{}"))
        assert code == 1 and "bad.json" in err


def test_every_sample_scene_adds_up():
    import os
    from harness import SCENES
    for name in ("bowling", "bricks", "solid", "coincident"):
        with Folder() as folder:
            summary = folder.render(os.path.join(SCENES, name, name + ".rib"), "--driver", "in-process", "-r", 3, "-s",
                                    2, "--format", "320x256", "--chord", "0.5")
        for frame in summary["frames"]:
            check_sums(frame)
        assert not summary["warnings"], summary["warnings"]


if __name__ == "__main__":
    main(globals())
