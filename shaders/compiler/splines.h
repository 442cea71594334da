/* SPDX-License-Identifier: Apache-2.0 */
#ifndef SPLINES_H
#define SPLINES_H

/* The bases of spline(): rows are powers of t from the third down, columns the four values; a
 * segment starts `step` values after the one before (RenderMan Interface 3.2, RiBasis). */
struct spline_basis {
    const char *name;
    int step;
    float matrix[4][4];
};

/* The first is meant when none is named. NULL: there is no basis of this name. */
const struct spline_basis *spline_basis_find(const char *name);

#endif
