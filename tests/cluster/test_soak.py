# SPDX-License-Identifier: Apache-2.0
"""Many launches of a small scene on six nodes in a row: every picture right, no hang, no leftover. The number of
launches is SOAK_LAUNCHES, 50 in the suite (15 under sanitizers); bench/soak runs 500."""

import os

from harness import SANITIZED, Folder, main

SCENE = """Format 200 150 1
Projection "perspective" "fov" [40]
WorldBegin
LightSource "distant" 1
Surface "plastic"
Translate 0 0 4
Sphere 1 -1 1 360
WorldEnd
"""


def test_launches_in_a_row():
    launches = int(os.environ.get("SOAK_LAUNCHES", "15" if SANITIZED else "50"))
    with Folder() as folder:
        scene = folder.write("soak.rib", SCENE)
        folder.render(scene, "--driver", "in-process", "-o", folder.file("right.exr"), "--compression", "none")
        with open(folder.file("right.exr"), "rb") as file:
            right = file.read()
        time_ps = set()
        for launch in range(launches):
            out = folder.file("launch.exr")
            summary = folder.render(scene, "-r", 3, "-s", 3, "-o", out, "--compression", "none")
            with open(out, "rb") as file:
                assert file.read() == right, "launch %d: another picture" % launch
            time_ps.add(summary["frames"][0]["time_ps"])
            os.unlink(out)
            assert len(time_ps) == 1, "launch %d: another time" % launch
        folder.assert_nothing_left()


if __name__ == "__main__":
    main(globals())
