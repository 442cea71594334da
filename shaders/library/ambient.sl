/* SPDX-License-Identifier: Apache-2.0
 *
 * ambient: light from everywhere.
 *
 * intensity, lightcolor
 */
light ambient(float intensity = 1; color lightcolor = 1;) {
    Cl = intensity * lightcolor;
}
