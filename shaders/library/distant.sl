/* SPDX-License-Identifier: Apache-2.0
 *
 * distant: parallel light, like that of the sun.
 *
 * intensity, lightcolor
 * from, to  the light shines in the direction from `from` to `to`
 */
light distant(float intensity = 1; color lightcolor = 1; point from = point "shader" (0, 0, 0);
              point to = point "shader" (0, 0, 1);) {
    solar (to - from, 0)
        Cl = intensity * lightcolor;
}
