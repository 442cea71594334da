/* SPDX-License-Identifier: Apache-2.0 */
#include "shaders/compiler/passes.h"

void pass_memory(struct ir_program *ir) {
    (void)ir;
}
