# SPDX-License-Identifier: Apache-2.0
"""Scenes in which something goes wrong."""

# a scene whose frames take a while, so that nodes can be killed in mid-frame
SLOW = """Format 1280 1024 1
Projection "perspective" "fov" [40]
WorldBegin
LightSource "point" 1 "uniform point from" [0 4 -4] "uniform float intensity" [30]
Surface "marble"
%s
WorldEnd
""" % "\n".join("AttributeBegin Translate %g %g %g Sphere 1 -1 1 360 AttributeEnd" % (i % 5 - 2, i // 5 % 5 - 2, 5 + i // 25)
                for i in range(50))
# its frame has a number of its own, and that is the number messages say
SLOW_70 = SLOW.replace("WorldBegin", "FrameBegin 70\nWorldBegin").replace("WorldEnd", "WorldEnd\nFrameEnd")
QUICK = """Format 64 48 1
WorldBegin
Surface "constant"
Sphere 1 -1 1 360
WorldEnd
"""
