# SPDX-License-Identifier: Apache-2.0
"""The picture does not depend on how shaders are compiled: instruction set, width of vectors, optimisation, compiler."""

import os
import shutil

from harness import Folder, main

SCENE = """Format 96 64 1
Projection "perspective" "fov" [40]
Display "out.exr" "file" "rgba"
WorldBegin
LightSource "ambient" 1 "intensity" [0.3]
LightSource "distant" 2 "from" [1 2 -1] "to" [0 0 0]
LightSource "spot" 3 "from" [0 2 0] "to" [0 0 6] "intensity" [20]
%s
WorldEnd
"""
SHADERS = ["marble", "planks", "ripple_reflection"]
PATCH = """AttributeBegin
Translate %g %g 6
Surface "%s"
Sphere 0.7 -0.7 0.7 360
AttributeEnd
"""


def variants():
    """Vector lanes (4: SSE2, 8: AVX2, 16: AVX-512 where the processor has them), flags after our own, compiler."""
    yield from [(4, "-O2", "cc"), (4, "-O0", "cc"), (8, "-O1", "cc"), (16, "-O2", "cc"), (8, "-O3", "cc")]
    if shutil.which("clang"):
        yield 8, "-O2", "clang"


def test_instruction_sets_optimisations_and_compilers_give_the_same_picture():
    scene = SCENE % "".join(PATCH % (1.5 * i - 1.5, 0, name) for i, name in enumerate(SHADERS))
    with Folder() as folder:
        path, reference = folder.write("scene.rib", scene), None
        for lanes, flags, compiler in variants():
            name = "%s%s-%d" % (compiler, flags, lanes)
            wrapper = folder.write(name, '#!/bin/sh\nexec %s "$@" %s\n' % (compiler, flags))
            os.chmod(wrapper, 0o700)
            os.environ.update(SORTLAST_CC=wrapper, SORTLAST_VECTOR_WIDTH=str(lanes), SORTLAST_CACHE=folder.file("cache"))
            picture = folder.file(name + ".exr")
            summary = folder.render(path, "-r", 1, "-s", 1, "-o", picture, "--driver", "in-process")
            assert summary["frames"], "nothing was rendered"
            if reference:
                folder.assert_same_picture(reference, picture)
            reference = reference or picture
        os.environ.update(SORTLAST_CC="cc", SORTLAST_VECTOR_WIDTH="8")
        folder.render(folder.write("other.rib", scene.replace('"intensity" [20]', '"intensity" [21]')), "-o",
                      folder.file("other.exr"), "--driver", "in-process")
        code, out, err = folder.run("compare", reference, folder.file("other.exr"))
        assert code != 0 or "max_error 0 " not in out + " ", "another light must change the picture:\n" + out


if __name__ == "__main__":
    main(globals())
