/* SPDX-License-Identifier: Apache-2.0
 *
 * spot: light in a cone with a soft rim.
 *
 * intensity, lightcolor   at distance 1
 * from, to                where it is, and what it points at
 * coneangle               from the axis to the rim
 * conedeltaangle          how much of that is soft
 * beamdistribution        how the light concentrates on the axis
 */
light spot(float intensity = 1; color lightcolor = 1; point from = point "shader" (0, 0, 0);
           point to = point "shader" (0, 0, 1); float coneangle = radians(30); float conedeltaangle = radians(5);
           float beamdistribution = 2;) {
    uniform vector axis = normalize(to - from);
    uniform float rim = cos(coneangle);
    uniform float inner = cos(coneangle - conedeltaangle);
    illuminate (from, axis, coneangle) {
        float along = (L . axis) / length(L);
        float fall = pow(along, beamdistribution) / (L . L);
        Cl = (intensity * fall * smoothstep(rim, inner, along)) * lightcolor;
    }
}
