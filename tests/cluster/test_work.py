# SPDX-License-Identifier: Apache-2.0
"""Work is in proportion to what the scene requires: samples that are covered, instances that are seen, features that
shaders use."""

import glob
import subprocess

import harness

HEAD = 'Format 640 512 1\nProjection "perspective" "fov" [90]\nClipping 0.1 100\nWorldBegin\nLightSource "distant" 1\n'


def work(folder, name, body, *arguments):
    scene = folder.write(name, HEAD + body + "WorldEnd\n")
    summary = folder.render(scene, "--driver", "in-process", "--explain-work", *arguments)
    return summary["frames"][0]


def strip(width):
    """A wall in front of the camera that covers the left `width` (0 to 1) of the picture."""
    right = -1.25 + 2.5 * width
    return 'Surface "matte"\nPolygon "P" [-1.25 -1 1 -1.25 1 1 %g 1 1 %g -1 1]\n' % (right, right)


def instructions(frame):
    return sum(sum(entry["instructions"].values())
               for entry in frame["work"]["instances"] + frame["work"]["lights"])


def test_work_is_linear_in_covered_samples():
    """Rays, shaded samples and issued instructions against covered samples lie on a line through the origin."""
    with harness.Folder() as folder:
        full = work(folder, "full.rib", strip(1))
        assert full["samples_covered"] == 640 * 512, full["samples_covered"]
        blank = work(folder, "blank.rib", 'Surface "matte"\n')
        for key in ["rays", "samples_composed", "regions_touched", "modules_loaded"]:
            assert blank["work"][key] == 0, (key, blank["work"])
        assert instructions(blank) == 0
        for width in [0.2, 0.4, 0.6, 0.8]:  # whole columns of regions
            frame = work(folder, "strip.rib", strip(width))
            share = frame["samples_covered"] / full["samples_covered"]
            assert abs(share - width) < 0.002, (share, width)
            for what, part, whole in [("rays", frame["work"]["rays"], full["work"]["rays"]),
                                      ("instructions", instructions(frame), instructions(full)),
                                      ("shaded", sum(e["samples"] for e in frame["work"]["instances"]),
                                       full["samples_covered"])]:
                # at most one column of tiles more than its share; the intercept is far below 1 %
                assert abs(part / whole - share) < 0.01, (what, width, part, whole)


def spheres(count, place):
    """Instances of their own: 3 spheres side by side in front, the others squares where `place` puts them."""
    text = ""
    for i in range(count):
        x, y, z = (i - 1, 0, 2) if i < 3 else place(i)
        shape = "Sphere 0.4 -0.4 0.4 360" if i < 3 else 'Polygon "P" [0 0 0  0.2 0 0  0.2 0.2 0  0 0.2 0]'
        text += 'TransformBegin\nTranslate %g %g %g\nSurface "plastic" "roughness" [%g]\n%s\nTransformEnd\n' \
                % (x, y, z, 0.05 + i * 0.001, shape)
    return text


def test_instances_out_of_sight_cost_nothing():
    """A thousand instances of which 3 lie in the view cost in everything what the 3 cost alone."""
    with harness.Folder() as folder:
        few = work(folder, "few.rib", spheres(3, None))
        many = work(folder, "many.rib", spheres(1000, lambda i: (1000 + i, 0, 4)))
        assert len(few["work"]["instances"]) == 3 + 1
        few.pop("image"), many.pop("image")
        assert few == many


def test_hidden_instances_are_neither_loaded_nor_run():
    """A thousand instances of which 3 are seen, the others behind a wall: shading is that of the 3."""
    wall = 'Surface "matte"\nPolygon "P" [-9 -9 3  9 -9 3  9 9 3  -9 9 3]\n'
    with harness.Folder() as folder:
        few = work(folder, "few.rib", wall + spheres(3, None))
        many = work(folder, "many.rib", wall + spheres(1000, lambda i: (i % 32 / 4 - 4, i // 32 / 4 - 4, 8)))
        idle = [entry for entry in many["work"]["instances"] if not entry["regions"]]
        assert len(idle) == 997 and all(not any(entry["instructions"].values()) for entry in idle)
        seen = [entry for entry in many["work"]["instances"] if entry["regions"]]
        assert seen == few["work"]["instances"], seen
        for key in ["lights", "modules_loaded", "samples_composed", "regions_touched"]:
            assert many["work"][key] == few["work"][key], key
        assert many["shading_busy_ps"] == few["shading_busy_ps"]
        assert many["composition"] == few["composition"]
        code, out, err = folder.run("render", folder.file("many.rib"), "--driver", "in-process", "--explain-work")
        assert code == 0, err
        assert "997 of 1001 instances: cover no sample" in out, out


# the first numbers of Perlin's permutation: in a compiled shader only if it can call noise
PERMUTATION = bytes([151, 160, 137, 91, 90, 15, 131, 13, 201, 95, 96, 53])


def test_a_shader_without_noise_links_none():
    with harness.Folder() as folder:
        def objects(name, shader):
            cache = folder.file("cache-" + name)
            scene = folder.write(name + ".rib", HEAD + 'Surface "%s"\nTranslate 0 0 4\nSphere 1 -1 1 360\nWorldEnd\n'
                                 % shader)
            environment = dict(folder.environment(), SORTLAST_CACHE=cache)
            subprocess.run([harness.SORTLAST, "render", scene, "-q", "--driver", "in-process"], check=True,
                           env=environment, cwd=folder.path)
            found = {}
            for path in glob.glob(cache + "/**/*.so", recursive=True):
                with open(path, "rb") as file:
                    found[path.rsplit("/", 1)[1]] = file.read()
            return found
        plain = objects("plain", "plastic")
        assert plain and not any(PERMUTATION in code for code in plain.values()), plain.keys()
        noisy = objects("noisy", "marble")
        assert any(PERMUTATION in code for code in noisy.values()), noisy.keys()
        assert sum(map(len, plain.values())) < sum(map(len, noisy.values()))


def dirt(*amounts):
    """Strips of wall, each an instance of its own with another bound value of a varying parameter."""
    body = 'Declare "dirt" "uniform float"\n'
    for i, amount in enumerate(amounts):
        left, right = -1.25 + i * 2.5 / len(amounts), -1.25 + (i + 1) * 2.5 / len(amounts)
        body += 'Surface "dirty" "dirt" [%g]\nPolygon "P" [%g -1 1 %g 1 1 %g 1 1 %g -1 1]\n' % (
            amount, left, left, right, right)
    return body


DIRTY = "surface dirty(varying float dirt = 0; uniform float fine = 1) { Ci = %s * (1 - dirt); }"


def test_instances_that_differ_in_no_uniform_value_run_together():
    """Three instances whose bound values are loaded by shader ID cost the array what one costs."""
    with harness.Folder() as folder:
        folder.write("dirty.sl", DIRTY % "noise(10 * P)")
        one = work(folder, "one.rib", dirt(0.2))
        three = work(folder, "three.rib", dirt(0.2, 0.5, 0.9))
        assert instructions(three) == instructions(one), (instructions(three), instructions(one))
        assert sum(three["shading_busy_ps"]) == sum(one["shading_busy_ps"])
        folder.write("dirty.sl", (DIRTY % "noise(10 * P)").replace("varying float dirt", "uniform float dirt"))
        apart = work(folder, "apart.rib", dirt(0.2, 0.5, 0.9))
        assert instructions(apart) > instructions(one)
        assert sum(apart["shading_busy_ps"]) > sum(one["shading_busy_ps"])


def test_streams_are_generated_once_and_again_only_when_a_value_changes():
    """Two frames of one scene; in the second a bound value of one of two instances is another."""
    with harness.Folder() as folder:
        folder.write("dirty.sl", DIRTY % "1")
        body = ""
        for number, amount in [(1, 0.5), (2, 0.5), (3, 0.75)]:
            head = HEAD.replace("WorldBegin\n", "")
            body += ("FrameBegin %d\n" % number + head.replace('LightSource "distant" 1\n', "") + "WorldBegin\n"
                     + dirt(0.25, amount) + "WorldEnd\nFrameEnd\n")
        frames = folder.render(folder.write("frames.rib", body), "--driver", "in-process")["frames"]
        counts = [(f["instruction_streams"]["generated"], f["instruction_streams"]["reused"]) for f in frames]
        assert counts == [(2, 0), (0, 2), (1, 1)], counts


if __name__ == "__main__":
    harness.main(globals())
