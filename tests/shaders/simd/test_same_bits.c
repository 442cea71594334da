/* SPDX-License-Identifier: Apache-2.0 */
/* Every instruction set, width and compiler gives the same bits: the results of 2^20 inputs a
 * function hash to the values in hashes.inc. `test_simd_same_bits --print` prints that file's table
 * (after a change that is meant to change results). */

#include "samples.h"

#include "base/hash.h"
#include "shaders/simd/vector_math.h"

#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define BLOCKS 256 /* 2^20 inputs */

static const struct {
    const char *name;
    uint64_t hash;
} expected[] = {
#include "hashes.inc"
};

/* Inputs of a block: all floats for the first argument of most functions; noise and half of the
 * pairs get ordinary numbers; the last block starts with special values. */
static void fill(const char *name, uint32_t block, float *x, float *y, float *z) {
    if (strstr(name, "noise") && block < BLOCKS - 16) {
        sample_uniform(x, 1, block, -1000.0, 1000.0);
        sample_uniform(y, 2, block, -1000.0, 1000.0);
        sample_uniform(z, 3, block, -1000.0, 1000.0);
        return;
    }
    sample_stratified(x, block, BLOCKS);
    if (block & 1) {
        sample_uniform(x, 7, block, 0.0, 20.0);
        sample_uniform(y, 4, block, -20.0, 20.0);
    } else {
        sample_patterns(y, 5, block);
    }
    sample_patterns(z, 6, block);
    if (block == BLOCKS - 1)
        sample_special(x);
}

static uint64_t hash_function(const struct vector_function *function) {
    static float x[SAMPLE_BLOCK], y[SAMPLE_BLOCK], z[SAMPLE_BLOCK], out[3][SAMPLE_BLOCK];
    uint64_t hash = 0;
    for (uint32_t block = 0; block < BLOCKS; block++) {
        fill(function->name, block, x, y, z);
        function->apply((const float *[]){x, y, z}, (float *[]){out[0], out[1], out[2]},
                        SAMPLE_BLOCK);
        for (int c = 0; c < function->outputs; c++)
            hash = hash_bytes(out[c], sizeof out[c], hash);
    }
    return hash;
}

static void all_instruction_sets_give_the_recorded_bits(void **state) {
    for (int s = 0; s < vector_kernel_set_count; s++) {
        const struct vector_kernels *kernels = vector_kernel_sets[s];
        if (!kernels->supported()) {
            print_message("%s: this processor does not have it\n", kernels->name);
            continue;
        }
        assert_int_equal(kernels->function_count, sizeof expected / sizeof *expected);
        for (int f = 0; f < kernels->function_count; f++) {
            assert_string_equal(kernels->functions[f].name, expected[f].name);
            uint64_t hash = hash_function(&kernels->functions[f]);
            if (hash != expected[f].hash)
                fail_msg("%s: %s hashes to 0x%016" PRIx64, kernels->name, expected[f].name, hash);
        }
    }
}

static void lengths_places_and_overlap_do_not_matter(void **state) {
    static const size_t lengths[] = {0, 1, 7, 8, 9, 15, 16, 17, 8191, 8192};
    static float x[3][8192 + 1], whole[3][8192], part[3][8192 + 1];
    for (uint32_t a = 0; a < 3; a++) {
        sample_uniform(x[a], a, 50, -3.0, 3.0);
        sample_patterns(x[a] + SAMPLE_BLOCK, a, 51);
    }
    for (int s = 0; s < vector_kernel_set_count; s++) {
        const struct vector_kernels *kernels = vector_kernel_sets[s];
        for (int f = 0; kernels->supported() && f < kernels->function_count; f++) {
            const struct vector_function *function = &kernels->functions[f];
            function->apply((const float *[]){x[0], x[1], x[2]},
                            (float *[]){whole[0], whole[1], whole[2]}, 8192);
            for (size_t l = 0; l < sizeof lengths / sizeof *lengths; l++) {
                /* in place, one float off alignment, with a guard behind */
                size_t n = lengths[l];
                for (int a = 0; a < 3; a++) {
                    memcpy(part[a] + 1, x[a], n * sizeof(float));
                    if (n < 8192)
                        part[a][n + 1] = 42.0f;
                }
                function->apply((const float *[]){part[0] + 1, part[1] + 1, part[2] + 1},
                                (float *[]){part[0] + 1, part[1] + 1, part[2] + 1}, n);
                for (int c = 0; c < function->outputs; c++) {
                    if (memcmp(part[c] + 1, whole[c], n * sizeof(float)) != 0)
                        fail_msg("%s: %s of %zu elements differs", kernels->name, function->name,
                                 n);
                    assert_true(n == 8192 || part[c][n + 1] == 42.0f);
                }
            }
        }
    }
}

#define TWIN_1(f)                                                                                  \
    if (strcmp(name, #f) == 0)                                                                     \
        return sf_##f(x);
#define TWIN_2(f)                                                                                  \
    if (strcmp(name, #f) == 0)                                                                     \
        return sf_##f(x, y);
#define TWIN_3(f)                                                                                  \
    if (strcmp(name, #f) == 0)                                                                     \
        return sf_##f(x, y, z);

static float twin(const char *name, float x, float y, float z) {
    VECTOR_FUNCTIONS_1(TWIN_1)
    VECTOR_FUNCTIONS_2(TWIN_2)
    VECTOR_FUNCTIONS_3(TWIN_3)
    float out[3];
    if (strcmp(name, "noise1_3") == 0)
        sf_noise1_3(x, out);
    else if (strcmp(name, "noise2_3") == 0)
        sf_noise2_3(x, y, out);
    else
        sf_noise3_3(x, y, z, out);
    return out[0];
}

static void scalar_twins_have_the_same_bits(void **state) {
    static float x[SAMPLE_BLOCK], y[SAMPLE_BLOCK], z[SAMPLE_BLOCK], out[3][SAMPLE_BLOCK];
    const struct vector_kernels *kernels = vector_kernels_best();
    for (int f = 0; f < kernels->function_count; f++) {
        const struct vector_function *function = &kernels->functions[f];
        for (uint32_t block = BLOCKS - 2; block < BLOCKS; block++) {
            fill(function->name, block, x, y, z);
            function->apply((const float *[]){x, y, z}, (float *[]){out[0], out[1], out[2]},
                            SAMPLE_BLOCK);
            for (int i = 0; i < SAMPLE_BLOCK; i++)
                if (sample_bits(twin(function->name, x[i], y[i], z[i])) != sample_bits(out[0][i]))
                    fail_msg("sf_%s(%a, %a, %a) differs", function->name, x[i], y[i], z[i]);
        }
    }
}

int main(int argc, char **argv) {
    if (argc > 1 && strcmp(argv[1], "--print") == 0) {
        const struct vector_kernels *kernels = vector_kernel_sets[0];
        for (int f = 0; f < kernels->function_count; f++)
            printf("{\"%s\", 0x%016" PRIx64 "},\n", kernels->functions[f].name,
                   hash_function(&kernels->functions[f]));
        return 0;
    }
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(all_instruction_sets_give_the_recorded_bits),
        cmocka_unit_test(lengths_places_and_overlap_do_not_matter),
        cmocka_unit_test(scalar_twins_have_the_same_bits),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
