/* SPDX-License-Identifier: Apache-2.0
 *
 * pointlight: light from one point in all directions, falling off with the square of the distance.
 *
 * intensity   of the light at distance 1
 * lightcolor
 * from        where it is
 */
light pointlight(float intensity = 1; color lightcolor = 1; point from = point "shader" (0, 0, 0);) {
    illuminate (from)
        Cl = (intensity / (L . L)) * lightcolor;
}
