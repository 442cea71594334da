# SPDX-License-Identifier: Apache-2.0
"""What `sortlast shader` says of a shader: sizes that add up, times in proportion to the paper's, passes that change
costs and never pictures, errors with their place."""

import json
import os
import xml.dom.minidom

import harness

LIBRARY = os.path.join(harness.SOURCE, "shaders", "library")
# PF table 4: total, varying, allocated bytes; table 1: us a region
TABLE_4 = {"simple_brick": (171, 97, 16), "fancy_brick": (239, 175, 101), "ripple_reflection": (341, 193, 137),
           "planks": (216, 152, 97)}
TABLE_1 = {"fancy_brick": 613.15, "ripple_reflection": 1058.07, "planks": 532.30, "bowling_pin": 401.96}
OPTIONAL_PASSES = ["arrays", "ssa", "fold", "cse", "copies", "moves", "sizes"]


def library(name):
    return os.path.join(LIBRARY, name + ".sl")


def report(folder, path, *arguments):
    code, out, err = folder.run("shader", path, "--json", "-", *arguments)
    assert code == 0, err
    return json.loads(out)


def test_sizes_add_up_and_offsets_follow_each_other():
    with harness.Folder() as folder:
        for name in TABLE_4:
            r = report(folder, library(name))
            at = 2  # behind the shader ID
            for parameter in r["transfer_map"]["parameters"]:
                assert parameter["offset"] == at, r["transfer_map"]
                at += parameter["bytes"]
            assert r["transfer_map"]["bytes"] == at
            m = r["memory"]
            assert m["free"] == m["available"] - m["transfer_map"] - m["position"] - m["communication"] - m["allocated"]
            assert max(l["address"] + l["bytes"] for l in m["lifetimes"]) == m["allocated"]
            for a in m["lifetimes"]:  # no two live at one place at one time
                for b in m["lifetimes"]:
                    together = a["first"] < b["last"] and b["first"] < a["last"]
                    overlap = a["address"] < b["address"] + b["bytes"] and b["address"] < a["address"] + a["bytes"]
                    assert a is b or not (together and overlap), (a, b)
            exact = sum(s["time_ps"]["exact"] for s in r["streams"].values())
            assert r["time_per_region_ps"]["exact"] == exact >= r["time_per_region_ps"]["fast"] > 0


def test_calls_say_what_they_save():
    with harness.Folder() as folder:
        marble = report(folder, library("marble"))
        calls = {c["function"]: c for c in marble["calls"]}
        assert sorted(calls) == ["pow", "sin"] and all(c["math"] == "exact" for c in marble["calls"])
        saved = sum(c["time_ps"]["exact"] - c["time_ps"]["fast"] for c in marble["calls"])
        assert saved == marble["time_per_region_ps"]["exact"] - marble["time_per_region_ps"]["fast"] > 0
        place = "%d:%d" % (calls["sin"]["line"], calls["sin"]["column"])
        one = report(folder, library("marble"), "--fast-calls", place)
        sine = calls["sin"]["time_ps"]
        assert one["time_per_region_ps"]["exact"] == marble["time_per_region_ps"]["exact"] - sine["exact"] + sine["fast"]
        code, out, err = folder.run("shader", library("marble"), "--fast-calls", "1:1")
        assert code == 1 and "marble has: sin at 30:30, pow at 45:18" in err, err
        code, out, err = folder.run("shader", library("marble"))
        assert code == 0 and "Calls with a fast version" in out and place in out, out


def test_the_tables_of_the_paper_are_met():
    with harness.Folder() as folder:
        reports = {name: report(folder, library(name)) for name in sorted(set(TABLE_4) | set(TABLE_1))}
        simple = reports["simple_brick"]["memory"]
        for key, paper in zip(["total", "varying", "allocated"], TABLE_4["simple_brick"]):
            assert abs(simple[key] - paper) <= 0.1 * paper, (key, simple[key], paper)
        for name, (total, varying, allocated) in TABLE_4.items():
            m = reports[name]["memory"]
            assert m["free"] >= 0 and m["spilled"] == 0, (name, m)
            assert m["allocated"] / m["varying"] <= allocated / varying, (name, m)
        us = {name: reports[name]["time_per_region_ps"]["exact"] / 1e6 for name in TABLE_1}
        assert us["planks"] < us["fancy_brick"] < us["ripple_reflection"], us
        for name, paper in TABLE_1.items():
            assert paper / 2 <= us[name] <= 2 * paper, (name, us[name], paper)


def test_a_parameter_moves_into_the_map_with_its_own_bytes():
    with harness.Folder() as folder:
        path = folder.write("p.sl", "surface p(float a = 1; fixed<12,4> b = 1; color c = 1;) { Ci = c * a * b * s; }")
        before = report(folder, path)["transfer_map"]["bytes"]
        for name, size in [("a", 4), ("b", 2), ("c", 12)]:
            assert report(folder, path, "--material", name)["transfer_map"]["bytes"] == before + size
        bound = report(folder, path, "-D", "c=1,0.5,0.25", "-D", "a=2")
        assert bound["transfer_map"]["bytes"] == before


def test_passes_that_may_be_left_out_change_no_picture():
    with harness.Folder() as folder:
        for name in ["simple_brick", "volume_wood"]:
            plain = folder.file("plain.exr")
            assert folder.run("shader", library(name), "--render", "-o", plain, "--format", "64x64")[0] == 0
            for left_out in OPTIONAL_PASSES + [",".join(OPTIONAL_PASSES)]:
                other = folder.file("other.exr")
                code, out, err = folder.run("shader", library(name), "--render", "-o", other, "--format", "64x64",
                                            "--without", left_out)
                assert code == 0, err
                folder.assert_same_picture(plain, other)


def test_every_pass_can_be_looked_at():
    with harness.Folder() as folder:
        for name in OPTIONAL_PASSES + ["storage", "dead", "bind", "hoist", "blocks", "memory", "emit"]:
            code, out, err = folder.run("shader", library("simple_brick"), "--dump", name)
            assert code == 0 and "FIXED_DIVIDE" in out, (name, err)
        assert folder.run("shader", library("simple_brick"), "--dump", "nothing")[0] == 1


def test_what_does_not_fit_is_spilled_and_costs():
    """Eighty values that live across a noise: 320 bytes."""
    with harness.Folder() as folder:
        many = "".join("float x%d = s * %d + t; " % (i, i) for i in range(80))
        use = " + ".join("x%d * n" % i for i in range(80))
        path = folder.write("big.sl", "surface big() { %s float n = noise(P); Ci = %s; }" % (many, use))
        r = report(folder, path)
        assert r["memory"]["spilled"] > 0 and r["memory"]["free"] >= 0, r["memory"]
        moved = sum(s["operations"].get("spill_byte", 0) for s in r["streams"].values())
        assert moved >= 2 * r["memory"]["spilled"], (moved, r["memory"]["spilled"])


def test_charts_and_explanations_come_out():
    with harness.Folder() as folder:
        code, out, err = folder.run("shader", library("fancy_brick"), "--svg", folder.file("m.svg"), "--explain")
        assert code == 0, err
        for heading in ["Transfer map", "Pixel memory", "Lifetimes", "Time per region", "Lines that cost most",
                        "with and without a pass"]:
            assert heading in out, heading
        assert xml.dom.minidom.parse(folder.file("m.svg")).getElementsByTagName("rect").length > 20


def test_a_picture_and_a_report_come_from_one_run():
    with harness.Folder() as folder:
        code, out, err = folder.run("shader", library("matte"), "--render", "-o", folder.file("m.exr"), "--png",
                                    "--format", "16x16", "--json", folder.file("m.json"))
        assert code == 0 and not out, (code, out, err)
        assert os.path.exists(folder.file("m.exr")) and os.path.exists(folder.file("m.png"))
        with open(folder.file("m.json")) as file:
            assert json.load(file)["shader"] == "matte"


def test_mistakes_are_shown_where_they_are():
    with harness.Folder() as folder:
        broken = folder.write("broken.sl", "surface broken() {\n    Ci = nois(P);\n}\n")
        for arguments, wanted in [((broken,), "broken.sl:2:10: error: there is no function 'nois'; did you mean 'noise'?"),
                                  (("missing.sl",), "cannot open shader missing.sl"),
                                  ((library("matte"), "-D", "Kx=1"), 'no parameter "Kx"'),
                                  ((library("matte"), "-D", "Ka=red"), '"red" is not a number'),
                                  ((library("matte"), "-D", "Ka=1,2"), "takes 1 values, not 2"),
                                  ((library("matte"), "--without", "storage"), "may be left out"),
                                  ((library("matte"), "--format", "3x2"), "both even"), ((), "which shader?")]:
            code, out, err = folder.run("shader", *arguments)
            assert code != 0 and wanted in err, (arguments, code, err)


if __name__ == "__main__":
    harness.main(globals())
