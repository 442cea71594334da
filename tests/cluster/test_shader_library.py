# SPDX-License-Identifier: Apache-2.0
"""Shaders of the library in pictures: what no check of a shader's text shows."""

from harness import Folder, main

# One polygon seen along z whose normals are those of a silhouette (the reflection goes on, away from the window) or
# of a surface that faces the eye.
MIRROR = """Format 128 64 1
Projection "orthographic"
Declare "windowcolor" "uniform color"
WorldBegin
Surface "%s" "windowcolor" [%g %g %g]
Polygon "P" [-9 -9 1  9 -9 1  9 9 1  -9 9 1] "N" [%s]
WorldEnd
"""
SILHOUETTE = "0.1 1 -0.006  0.4 1 -0.006  0.4 1 0  0.1 1 0"
FACING = "0 0.2 -1  0.3 0.2 -1  0.3 0.6 -1  0 0.6 -1"


def test_polish_mirrors_the_window_only_where_it_is():
    for shader in ("bowling_ball", "bowling_pin"):
        for normals, same in ((SILHOUETTE, True), (FACING, False)):
            with Folder() as folder:
                for name, bright in (("dark", 0), ("bright", 12)):
                    scene = folder.write(name + ".rib", MIRROR % (shader, bright, bright, bright, normals))
                    folder.render(scene, "--driver", "in-process", "-o", folder.file(name + ".exr"))
                code, out, err = folder.run("compare", folder.file("dark.exr"), folder.file("bright.exr"))
                assert code == (0 if same else 1), "%s, normals %s: %s%s" % (shader, normals, out, err)


if __name__ == "__main__":
    main(globals())
