/* SPDX-License-Identifier: Apache-2.0 */
#ifndef FOLD_H
#define FOLD_H

#include "shaders/compiler/ir.h"

/* Evaluation of single instructions on constants: the bits that generated code computes. */

/* A fixed-point result: the raw number in the given format, which must have the exponent that the
 * operation's rule (fixed_format.h) gives, or a lower one for a conversion. */
int64_t fold_fixed(enum ir_operation operation, const struct ir_operand *operands,
                   struct fixed_format result);
/* The exponent to which the coordinates of a noise are brought. */
int fixed_noise_exponent(const struct ir_operand *coordinates, int count);
float fold_fixed_to_float(const struct ir_operand *operand);
bool fold_fixed_comparison(enum ir_operation operation, const struct ir_operand *operands);

#endif
