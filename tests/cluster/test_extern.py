# SPDX-License-Identifier: Apache-2.0
"""Shaders that call functions of an object of the user's: extern "C", and only with --link."""

import json
import subprocess

from harness import Folder, main

OBJECT = """
#include <math.h>
float stripes(float x, float count) { return fmodf(floorf(x * count), 2.0f) == 0.0f ? 0.0f : 1.0f; }
float level(void) { return 0.75f; }
float sum8(float a, float b, float c, float d, float e, float f, float g, float h) {
    return a + b + c + d + e + f + g + h;
}
"""
SHADER = """extern "C" float stripes(float x; float count;);
extern "C" float level();
extern "C" float sum8(float a, b, c, d, e, f, g, h);
surface striped(uniform float n = 7;) {
    float v = 0.25;
    if (s > 0.3)
        v = stripes(t, n);
    Ci = color (v, level() * stripes(1 - s, 5), sum8(s, t, 0, 0, 0, 0, 0, 0) / 2);
}
"""
# The same without functions from outside.
PLAIN = """surface striped(uniform float n = 7;) {
    float v = 0.25;
    if (s > 0.3)
        v = mod(floor(t * n), 2) == 0 ? 0 : 1;
    Ci = color (v, 0.75 * (mod(floor((1 - s) * 5), 2) == 0 ? 0 : 1), (s + t) / 2);
}
"""
SCENE = ('Format 300 150 1\nPixelSamples 1 1\nProjection "perspective" "fov" [50]\nWorldBegin\n'
         'Surface "striped"\nPatch "bilinear" "P" [-2 1 4  2 1 5  -2 -1 4  2 -1 4]\nWorldEnd\n')


def prepare(folder, shader=SHADER, code=OBJECT):
    source = folder.write("mine.c", code)
    subprocess.run(["cc", "-shared", "-fPIC", "-O1", "-o", folder.file("mine.so"), source, "-lm"], check=True)
    folder.write("striped.sl", shader)
    return folder.write("scene.rib", SCENE)


def refused(folder, *arguments):
    code, out, err = folder.run(*arguments)
    assert code == 1, (code, out, err)
    return err


def test_the_picture_is_that_of_the_same_shader_without_them():
    with Folder() as folder:
        scene = prepare(folder)
        pictures = []
        for driver in ("in-process", "processes"):
            for r, s in ((1, 1), (2, 3)):
                name = folder.file("%s-%d.exr" % (driver, r))
                folder.render(scene, "-o", name, "--driver", driver, "-r", r, "-s", s, "--link", "mine.so")
                pictures.append(name)
        for other in pictures[1:]:
            folder.assert_same_picture(pictures[0], other)
        folder.write("striped.sl", PLAIN)
        folder.render(scene, "-o", folder.file("plain.exr"))
        folder.assert_same_picture(pictures[0], folder.file("plain.exr"))
        folder.assert_nothing_left()


def test_without_permission_the_shader_is_refused():
    with Folder() as folder:
        scene = prepare(folder)
        for arguments in (["render", scene], ["render", scene, "--driver", "in-process"], ["shader", "striped.sl"]):
            err = refused(folder, *arguments)
            assert "striped.sl:1:1: error:" in err and "--link FILE.so" in err, err


def test_what_is_missing_is_named():
    with Folder() as folder:
        scene = prepare(folder, code="float stripes(float x, float n) { return x; }\nfloat level(void) { return 1; }")
        for arguments in (["render", scene, "--link", "mine.so"],
                          ["render", scene, "--link", "mine.so", "--driver", "in-process"],
                          ["shader", "striped.sl", "--link", "mine.so"]):
            code, out, err = folder.run(*arguments)
            assert code != 0 and "sum8()" in err and "mine.so" in err, (code, err)
        code, out, err = folder.run("render", scene, "--link", "none.so")
        assert code != 0 and "cannot link none.so" in err, (code, err)
        folder.assert_nothing_left()


def test_another_object_of_the_same_name_is_another_picture():
    with Folder() as folder:
        scene = prepare(folder)
        folder.render(scene, "-o", folder.file("a.exr"), "--link", "mine.so")
        prepare(folder, code=OBJECT.replace("0.75f", "0.5f"))
        folder.render(scene, "-o", folder.file("b.exr"), "--link", "mine.so")
        code, out, err = folder.run("compare", folder.file("a.exr"), folder.file("b.exr"))
        assert "max_error 2.5" in out, out + err


def test_calls_are_charged():
    with Folder() as folder:
        prepare(folder)
        code, out, err = folder.run("shader", "striped.sl", "--link", "mine.so", "--json", "-")
        assert code == 0, err
        with_calls = json.loads(out)["time_per_region_ps"]["exact"]
        assert with_calls > 3 * 81920000, with_calls  # two of stripes and one of sum8 vary, level() is uniform
        assert with_calls < 4 * 81920000, with_calls


main(globals())
