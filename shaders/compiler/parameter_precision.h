/* SPDX-License-Identifier: Apache-2.0 */
#ifndef PARAMETER_PRECISION_H
#define PARAMETER_PRECISION_H

#include "shaders/compiler/shader_compile.h"

/* What a component of a material parameter takes on the composition network. Fixed-point parameters
 * of the language have a size of their own and keep it. */
bool parameter_precision_applies(const struct shader_parameter *parameter);
int parameter_precision_bits(enum parameter_precision precision,
                             const struct shader_parameter *parameter);

/* The names in options, in the order of the enum, ended by NULL. */
extern const char *const parameter_precision_names[];

#endif
