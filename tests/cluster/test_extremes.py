# SPDX-License-Identifier: Apache-2.0
"""The edges of number formats and sizes: each has the right result or a clear message (docs/extremes.md)."""

import json
import math
import os
import random
import struct

import harness

HEAD = 'Format 64 48 1\nProjection "perspective" "fov" [90]\nClipping 0.1 1000\n'
WORLD = 'WorldBegin\nLightSource "distant" 1\nSurface "matte"\n'
WALL = 'Polygon "P" [-9 -9 2  9 -9 2  9 9 2  -9 9 2]\n'


class Extremes(harness.Folder):
    def picture(self, scene, *arguments):
        """(channels, summary) of a scene text, rendered in one process."""
        path = self.write("scene.rib", scene)
        summary = self.render(path, "--driver", "in-process", "-o", self.file("picture.exr"), "--compression", "none",
                              *arguments)
        return harness.read_exr(self.file("picture.exr")), summary

    def message(self, scene, *arguments):
        """The message of a scene that is refused."""
        path = self.write("scene.rib", scene)
        code, out, err = self.run("render", path, "-q", "--driver", "in-process", *arguments)
        assert code in (1, 2) and err.startswith("sortlast: "), (code, out, err)
        return err

    def shader(self, name, text):
        os.makedirs(self.file("shaders"), exist_ok=True)
        return self.write("shaders/" + name + ".sl", text)


def numbers(planes, channel):
    return [value for row in planes[channel] for value in row]


def check(planes, summary, covered, low=None, high=None):
    """How many pixels are covered, between which depths; nothing is not finite, and nothing was refused unseen."""
    depths = [z for z, a in zip(numbers(planes, "Z"), numbers(planes, "A")) if a]
    assert len(depths) == covered, len(depths)
    assert all(math.isfinite(v) for c in "RGBAZ" for v in numbers(planes, c))
    assert all(low * (1 - 1e-6) <= z <= high * (1 + 1e-6) for z in depths), (min(depths), max(depths))
    frame = summary["frames"][0]
    assert frame["nan_depths"] == 0 and frame["nan_colours"] == 0, frame


def triangle(*coordinates):
    return 'Polygon "P" [%s]\n' % " ".join(map(str, coordinates))


def test_numbers_that_are_not_finite_are_refused_with_their_place():
    with Extremes() as e:
        for number in ["nan", "inf", "-inf", "1e400", "-1e39"]:
            for place in range(3):
                corner = [0, 0, 2]
                corner[place] = number
                text = e.message(HEAD + WORLD + triangle(*corner, 1, 0, 2, 0, 1, 2) + "WorldEnd\n")
                assert "scene.rib:7:" in text, text
                assert "finite" in text or "beyond the range of floats" in text, text
        text = e.message(HEAD + WORLD + 'Surface "plastic" "roughness" [nan]\nSphere 1 -1 1 360\nWorldEnd\n')
        assert "scene.rib:7:" in text and "roughness" in text, text


def test_degenerate_triangles_cover_nothing():
    with Extremes() as e:
        for name, corners in [("no area", (0, 0, 2, 0, 0, 2, 0, 0, 2)), ("collinear", (0, 0, 2, 1, 1, 2, 2, 2, 2)),
                              ("behind", (0, 0, -2, 1, 0, -2, 0, 1, -2)), ("in the eye", (-1, -1, 0, 1, -1, 0, 0, 1, 0)),
                              ("seen on edge", (-1, 0, 1, 1, 0, 1, 0, 0, 5))]:
            planes, summary = e.picture(HEAD + WORLD + triangle(*corners) + "WorldEnd\n")
            assert not any(numbers(planes, "A")), name
            assert summary["frames"][0]["nan_depths"] == 0


def test_needles_and_large_coordinates_are_right():
    with Extremes() as e:
        # from 1e-30 to 1e30: the sliver around the diagonal holds no sample but perhaps those on it
        planes, summary = e.picture(HEAD + WORLD + triangle("1e-30", 0, 2, "1e30", "1e30", 2, 0, "1e-30", 2) + "WorldEnd\n")
        assert sum(map(bool, numbers(planes, "A"))) <= 48
        # beyond 2^23 floats have no fractions: the triangle still covers every sample
        far = "8388608.5"
        planes, summary = e.picture(HEAD + WORLD + triangle("-" + far, "-" + far, 2, far, "-" + far, 2, 0, far, 2)
                                    + "WorldEnd\n")
        check(planes, summary, 64 * 48, 2, 2)
        # one corner far outside: the same samples however far it is
        counts = set()
        for x in ["1e8", "1e15", "1e18", "1e19", "1e25", "3.4e38"]:
            planes, summary = e.picture(HEAD + WORLD + triangle(x, 0, 2, 1, 0, 2, 0, 1, 2) + "WorldEnd\n")
            counts.add(sum(map(bool, numbers(planes, "A"))))
        assert counts == {318}, counts
        # a triangle through the plane of the eye is cut at the near plane
        planes, summary = e.picture(HEAD + WORLD + triangle(-1, -1, -2, 1, -1, 2, 0, 1, 2) + "WorldEnd\n")
        check(planes, summary, 1440, 0.1, 2)


def test_scenes_of_every_scale_look_the_same():
    with Extremes() as e:
        reference = None
        for exponent in [0, 20, 38 - 3, -20, -28, 19, -9]:
            scale = "1e%d" % exponent
            planes, summary = e.picture(HEAD.replace("0.1 1000", "1e%d 1e%d" % (exponent - 1, exponent + 1)) + WORLD
                                        + "Scale %s %s %s\n" % (scale, scale, scale)
                                        + triangle(-1, -1, 2, 1, -1, 2, 0, 1, 2) + "WorldEnd\n")
            check(planes, summary, 288, 2 * 10.0 ** exponent, 2 * 10.0 ** exponent)
            reference = reference or planes["R"]
            assert planes["R"] == reference
        # nothing nearer than 1e-30 is drawn (docs/extremes.md)
        planes, summary = e.picture(HEAD.replace("0.1 1000", "1e-39 1") + WORLD + "Scale 1e-38 1e-38 1e-38\n"
                                    + triangle(-1, -1, 2, 1, -1, 2, 0, 1, 2) + "WorldEnd\n")
        assert not any(numbers(planes, "A"))


def test_singular_transformations_draw_nothing_and_say_so():
    with Extremes() as e:
        for transform in ["Translate 0 0 2\nScale 0 1 1", "ConcatTransform [0 0 0 0  0 0 0 0  0 0 0 0  0 0 2 1]",
                          "ConcatTransform [1 0 0 0  0 1 0 0  0 0 1 0  0 0 2 0]"]:
            planes, summary = e.picture(HEAD + WORLD + transform + "\nSphere 1 -1 1 360\nWorldEnd\n")
            assert not any(numbers(planes, "A"))
            assert any("singular" in warning for warning in summary["warnings"]), summary["warnings"]
        for clipping in ["2 2", "3 2", "-1 2"]:
            assert "Clipping" in e.message(HEAD.replace("0.1 1000", clipping) + WORLD + WALL + "WorldEnd\n")


def test_a_mesh_with_corners_on_samples_covers_each_once():
    """Vertices and edges lie exactly on sample centres; triangles turn either way and begin anywhere."""
    draw = random.Random(5)
    width, height = 32, 16
    faces, points = [], []
    for y in range(-1, height + 1):
        for x in range(-1, width + 1):
            points.append("%g %g 2" % ((x + 0.5) / 8 - 2, 1 - (y + 0.5) / 8))
    stride = width + 2
    for y in range(height + 1):
        for x in range(width + 1):
            a, b, c, d = y * stride + x, y * stride + x + 1, (y + 1) * stride + x + 1, (y + 1) * stride + x
            for face in ([a, b, c], [a, c, d]) if draw.random() < 0.5 else ([a, b, d], [b, c, d]):
                first = draw.randrange(3)
                face = face[first:] + face[:first]
                faces.append(face if draw.random() < 0.5 else face[::-1])
    draw.shuffle(faces)
    mesh = 'PointsPolygons [%s] [%s] "P" [%s]\n' % (" ".join("3" for _ in faces),
                                                  " ".join(str(i) for face in faces for i in face), " ".join(points))
    scene = 'Format %d %d 1\nProjection "orthographic"\nScreenWindow -2 2 -1 1\nWorldBegin\nSurface "constant"\n%sWorldEnd\n' \
            % (width, height, mesh)
    with Extremes() as e:
        planes, summary = e.picture(scene)
        check(planes, summary, width * height, 2, 2)
        assert all(a == 1 for a in numbers(planes, "A"))
        assert summary["frames"][0]["samples_covered"] == width * height
        again, summary = e.picture(scene, "-r", "5", "-s", "3")
        assert again == planes


def test_built_ins_at_the_edges_are_as_documented():
    """docs/extremes.md has the table; in varying and in uniform code. What is not finite is counted."""
    inf, nan = math.inf, math.nan
    cases = [("pow(z, z)", 1), ("pow(-o, 0.5)", nan), ("pow(z, -o)", inf), ("log(z)", -inf), ("log(-o)", nan),
             ("sqrt(-o)", nan), ("inversesqrt(z)", inf), ("smoothstep(o, o, z)", 0), ("smoothstep(o, o, o + o)", 1),
             ("mod(o, z)", nan), ("mod(-o, 3)", 2), ("o / z", inf), ("z / z", nan), ("-o / z", -inf),
             ("asin(o + 1.2e-7)", nan), ("acos(o + o)", nan), ("acos(o)", 0), ("length(vector (z, z, z))", 0),
             ("length(normalize(vector (z, z, z)))", nan), ("noise(2147483648 * o)", 0.5), ("noise(1e30 * o)", 0.5),
             ("noise(-z)", 0.5), ("noise(z / z)", nan), ("noise(o / z)", nan), ("exp(100000 * o)", inf),
             ("exp(-100000 * o)", 0), ("clamp(z / z, 0, 1)", 0), ("min(z / z, o)", 1), ("max(z / z, o)", 1),
             ("atan(z, z)", 0), ("sign(z)", 0), ("floor(1e30 * o)", 1e30), ("mix(z, o, z / z)", nan),
             ("1e38 * o * 10", inf), ("1e-38 * o * 1e-7", struct.unpack("<f", struct.pack("<f", 1e-45))[0]),
             ("spline(2 * o, 0, 1, 2, 3)", 2), ("abs(-z)", 0), ("cos(1e30 * o) * cos(1e30 * o) + sin(1e30 * o) * sin(1e30 * o)", 1)]
    with Extremes() as e:
        for is_uniform in [False, True]:
            name = "uniform_edges" if is_uniform else "varying_edges"
            parameters = "uniform float z = 0; uniform float o = 1" if is_uniform else ""
            text = "" if is_uniform else "float z = s * 0, o = s * 0 + 1;\n"
            if is_uniform:
                text += "".join("uniform float u%d = %s;\n" % (i, case[0]) for i, case in enumerate(cases))
            text += "float v = 0, k = floor(s);\n"
            text += "".join("if (k == %d) v = %s;\n" % (i, "u%d" % i if is_uniform else case[0])
                            for i, case in enumerate(cases))
            e.shader(name, "surface %s(%s) {\n%sCi = color (v, v, v);\n}\n" % (name, parameters, text))
            count = len(cases)
            planes, summary = e.picture('Format %d 1 1\nProjection "orthographic"\nScreenWindow 0 %d -1 1\nWorldBegin\n'
                                        'Surface "%s"\nPolygon "P" [0 -1 2 %d -1 2 %d 1 2 0 1 2] "s" [0 %d %d 0]\nWorldEnd\n'
                                        % (count, count, name, count, count, count, count))
            bad = 0
            for (expression, wanted), value in zip(cases, planes["R"][0]):
                same = math.isnan(value) if math.isnan(wanted) else \
                    value == wanted or abs(value - wanted) < 1e-6 * abs(wanted)
                assert same, (expression, value, wanted)
                bad += not math.isfinite(value)
            assert summary["frames"][0]["nan_colours"] == 3 * bad
            assert any("%d colour components" % (3 * bad) in warning for warning in summary["warnings"])


def test_loops_of_none_and_of_a_million_turns():
    with Extremes() as e:
        e.shader("turns", "surface turns(uniform float count = 0) { float i, sum = 0; for (i = 0; i < count * (1 + 0 * s); i += 1) "
                          "sum += 1; Ci = color (sum, sum, sum); }\n")
        for count, wanted in [(0, 0), (1, 1), (1000000, 1000000)]:
            planes, summary = e.picture('Format 2 2 1\nProjection "orthographic"\nWorldBegin\nSurface "turns" "uniform float count" [%d]\n'
                                        % count + WALL + "WorldEnd\n")
            assert set(numbers(planes, "R")) == {wanted}
            assert summary["warnings"] == [], summary["warnings"]
        e.shader("forever", "surface forever() { float i = 0; while (i < 2 + s * 0) i = 1 - i * 0.5; Ci = color (i, 0, 0); }\n")
        planes, summary = e.picture('Format 2 2 1\nProjection "orthographic"\nWorldBegin\nSurface "forever"\n' + WALL
                                    + "WorldEnd\n")
        assert any("a loop was stopped after 1048576 turns" in warning for warning in summary["warnings"])


def test_no_light_and_a_thousand_lights():
    with Extremes() as e:
        dark, _ = e.picture(HEAD + 'WorldBegin\nSurface "matte"\n' + WALL + "WorldEnd\n")
        assert set(numbers(dark, "R")) == {0}
        lights = "".join('LightSource "distant" %d "intensity" [0.001]\n' % (i + 1) for i in range(1000))
        many, summary = e.picture(HEAD + "WorldBegin\n" + lights + 'Surface "matte"\n' + WALL + "WorldEnd\n")
        one, _ = e.picture(HEAD + WORLD + WALL + "WorldEnd\n")
        for a, b in zip(numbers(many, "R"), numbers(one, "R")):
            assert abs(a - b) < 1e-4 * abs(b), (a, b)  # 1000 additions of floats


def test_colours_beyond_one_and_below_zero_are_kept():
    with Extremes() as e:
        e.shader("wild", "surface wild() { Ci = color (70000, -3, 1e-40); }\n")
        planes, summary = e.picture('Format 3 3 1\nProjection "orthographic"\nWorldBegin\nSurface "wild"\n' + WALL
                                    + "WorldEnd\n", "--png")
        tiny = struct.unpack("<f", struct.pack("<f", 1e-40))[0]
        assert [set(numbers(planes, c)) for c in "RGB"] == [{70000}, {-3}, {tiny}]


def test_positions_are_rebuilt_from_depth_to_2_to_the_minus_22():
    """P as a shader sees it against the plane it lies on, from depth 1e-6 to 1e9."""
    with Extremes() as e:
        e.shader("where", "surface where() { Ci = color (xcomp(P), ycomp(P), zcomp(P)); }\n")
        for depth in [1e-6, 1e-3, 1.0, 777.0, 1e6, 1e9]:
            wide = 4 * depth
            planes, summary = e.picture('Format 64 64 1\nProjection "perspective" "fov" [90]\nClipping 1e-9 2e9\nWorldBegin\n'
                                        'Surface "where"\nPolygon "P" [%g %g %g %g %g %g %g %g %g %g %g %g]\nWorldEnd\n'
                                        % (-wide, -wide, depth, wide, -wide, depth, wide, wide, depth, -wide, wide, depth))
            for row in range(64):
                for column in range(64):
                    x, y = (column + 0.5) / 32 - 1, 1 - (row + 0.5) / 32
                    for channel, wanted in [("R", x * depth), ("G", y * depth), ("B", depth)]:
                        value = planes[channel][row][column]
                        assert abs(value - wanted) <= abs(depth) * 2 ** -22, (depth, row, column, channel, value, wanted)


def test_pictures_of_every_size():
    with Extremes() as e:
        orthographic = 'Projection "orthographic"\nScreenWindow -1 1 -1 1\nWorldBegin\nSurface "constant"\n' + WALL + "WorldEnd\n"
        for width, height in [(1, 1), (1, 300), (300, 1), (127, 63), (129, 65), (65536, 1), (1, 65536)]:
            planes, summary = e.picture("Format %d %d 1\n" % (width, height) + orthographic)
            check(planes, summary, width * height, 2, 2)
            assert len(planes["A"]) == height and len(planes["A"][0]) == width
        for size in ["0 5 1", "5 0 1", "-1 5 1", "65537 1 1"]:
            assert "must be 1 to 65536" in e.message("Format %s\n" % size + orthographic)
        # 16384 x 16384 without a surface: regions are counted, nothing else is done. (Under MALLOC_PERTURB_, which meson
        # sets, calloc would write to all of its 6 GB.)
        os.environ.pop("MALLOC_PERTURB_", None)
        path = e.write("large.rib", "Format 16384 16384 1\nWorldBegin\nWorldEnd\n")
        summary = e.render(path, "--driver", "in-process")
        assert summary["frames"][0]["regions"] == 128 * 256 and summary["frames"][0]["samples_covered"] == 0
        # without a picture to write there is none in memory, and its size has no limit
        summary = e.render(path, "--driver", "in-process", "--format", "65536x16384")
        assert summary["frames"][0]["regions"] == 512 * 256 and summary["frames"][0]["samples_covered"] == 0


def test_clusters_of_every_size_give_one_picture():
    with Extremes() as e:
        scene = HEAD + WORLD + "Translate 0 0 3\nSphere 1 -1 1 360\nWorldEnd\n"
        reference, _ = e.picture(scene)
        for nodes in [2, 3, 7, 64, 1024]:
            planes, _ = e.picture(scene, "-r", str(nodes), "-s", str(nodes))
            assert planes == reference, nodes
        for option in ["-r", "-s"]:
            assert "from 1 to" in e.message(scene, option, "0")


def test_machines_from_one_byte_a_second_to_a_thousand_terabytes():
    """Times stay exact: those of the composition network are in inverse proportion to its rate, or it is said that they
    are beyond 63 bits of ticks."""
    with open(os.path.join(harness.SOURCE, "machines", "pixelflow.json")) as file:
        base = json.load(file)
    with Extremes() as e:
        scene = HEAD + WORLD + WALL + "WorldEnd\n"

        def run(**parameters):
            machine = json.loads(json.dumps(base))
            for name, value in parameters.items():
                machine["parameters"][name]["value"] = value
            path = e.write("machine.json", json.dumps(machine))
            code, out, err = e.run("render", e.write("scene.rib", scene), "-q", "--driver", "in-process", "--machine", path,
                                   "--json", "-")
            return (json.loads(out)["frames"][0], None) if code == 0 else (None, err)
        usual, _ = run()
        word_bytes = usual["composition"]["bytes"]["total"]
        for rate in [1, 7, 999999937, 10 ** 15]:
            frame, message = run(composition_bytes_per_s=rate)
            if frame:
                exact = word_bytes * 10 ** 12 / rate
                assert abs(frame["composition"]["busy_ps"] - exact) <= 1 + exact * 1e-15, (rate, frame["composition"])
            else:
                assert "63 bits" in message or "ticks" in message, message
        for latency in [0, 10 ** 12]:  # the longest, a second
            frame, message = run(composition_hop_latency_ps=latency)
            assert frame, message
            assert frame["time_ps"] >= latency and frame["composition"]["bytes"] == usual["composition"]["bytes"]
        frame, message = run(composition_hop_latency_ps=365 * 24 * 3600 * 10 ** 12)  # a year is more than 2^53 ps
        assert frame is None and "composition_hop_latency_ps" in message and "below 2^53" in message, message
        frame, message = run(composition_hop_latency_ps=10 ** 12 + 1)
        assert frame is None and "must lie in 0 .. 1000000000000" in message, message
        # rates whose common ticks are finer than 2^-63 of the frame
        frame, message = run(composition_bytes_per_s=999999937, geometry_bytes_per_s=999999893)
        assert frame is None and "sortlast: " in message, (frame, message)


def test_files_at_the_edges():
    with Extremes() as e:
        for name, text in [("empty", ""), ("only a comment", "# nothing\n"), ("no world", HEAD)]:
            assert "no world block" in e.message(text), name
        whole = HEAD + WORLD + WALL + "WorldEnd\n"
        for cut in [len(HEAD) + 8, len(whole) - 14, len(whole) - 40]:
            assert "scene.rib:" in e.message(whole[:cut])
        assert "scene.rib:7:" in e.message(HEAD + WORLD + 'Polygon "P" [0,5 0 2 1 0 2 0 1 2]\nWorldEnd\n')
        # a locale with decimal commas changes nothing
        plain, _ = e.picture(whole)
        os.environ["LC_ALL"] = "de_DE.UTF-8"
        try:
            german, _ = e.picture(whole)
        finally:
            del os.environ["LC_ALL"]
        assert german == plain


if __name__ == "__main__":
    harness.main(globals())
