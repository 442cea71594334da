/* SPDX-License-Identifier: Apache-2.0
 *
 * constant: the surface color itself, lit by nothing.
 *
 * No parameters.
 */
surface constant() {
    Oi = Os;
    Ci = Os * Cs;
}
