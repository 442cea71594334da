/* SPDX-License-Identifier: Apache-2.0 */
#include "accuracy.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

static const struct {
    const char *text;
    float x;
} inputs[] = {{"-Inf", -INFINITY},
              {"-FLT_MAX", -0x1.fffffep127f},
              {"-1", -1.0f},
              {"-2^-149", -0x1p-149f},
              {"-0", -0.0f},
              {"+0", 0.0f},
              {"2^-149", 0x1p-149f},
              {"1", 1.0f},
              {"1+2^-23", 0x1.000002p0f},
              {"FLT_MAX", 0x1.fffffep127f},
              {"Inf", INFINITY},
              {"NaN", NAN}};

enum { INPUT_COUNT = sizeof inputs / sizeof *inputs };

void special_table(const struct vector_kernels *kernels) {
    printf("%-12s", "function");
    for (int i = 0; i < INPUT_COUNT; i++)
        printf(" %12s", inputs[i].text);
    printf("\n");
    for (int f = 0; f < kernels->function_count; f++) {
        const struct vector_function *function = &kernels->functions[f];
        if (function->inputs != 1 || function->outputs != 1)
            continue;
        printf("%-12s", function->name);
        for (int i = 0; i < INPUT_COUNT; i++) {
            float y;
            function->apply((const float *[]){&inputs[i].x}, (float *[]){&y}, 1);
            if (isnan(y))
                printf(" %12s", "NaN");
            else
                printf(" %12.6g", (double)y);
        }
        printf("\n");
    }
}
