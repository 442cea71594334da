/* SPDX-License-Identifier: Apache-2.0 */
#include "base/rng.h"
#include "shaders/compiler/shader_compile.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

/* Sources that are nearly right find more than noise: seeded mutations of the corpus and the
 * library. */

enum { SOURCE_MAX = 16384, FILES_MAX = 160 };

static const char *const words[] = {"float ",
                                    "color ",
                                    "point ",
                                    "uniform ",
                                    "varying ",
                                    "if (",
                                    "else ",
                                    "for (",
                                    "while (",
                                    "break 2;",
                                    "continue;",
                                    "return ",
                                    "illuminance (P) ",
                                    "{",
                                    "}",
                                    "(",
                                    ")",
                                    "[",
                                    "]",
                                    ";",
                                    ",",
                                    "= ",
                                    "+= ",
                                    ". ",
                                    "^ ",
                                    "? ",
                                    ": ",
                                    "noise(",
                                    "normalize(",
                                    "transform(\"shader\", ",
                                    "transform(\"NDC\", ",
                                    "Du(",
                                    "lightsource(\"x\", ",
                                    "format(\"%f\", ",
                                    "illuminance (\"a\", P, N, 1) ",
                                    "displacement ",
                                    "volume ",
                                    "imager ",
                                    "option(\"Format\", ",
                                    "##",
                                    "#",
                                    "s",
                                    "Ci",
                                    "N",
                                    "1e38",
                                    "0",
                                    "output ",
                                    "string ",
                                    "\"world\"",
                                    "ambient()",
                                    "Cl",
                                    "L",
                                    "&&",
                                    "!",
                                    "surface ",
                                    "light ",
                                    "solar (",
                                    "/*",
                                    "\n#define ",
                                    "\n#if ",
                                    "\n#else\n",
                                    "\n#endif\n",
                                    "\n#include \"macros.h\"\n",
                                    "matrix ",
                                    "spline(\"linear\", ",
                                    "random()",
                                    "defined(",
                                    "F(",
                                    "\\\n",
                                    "\n"};

static size_t mutate(char *text, size_t length, struct rng *rng) {
    int edits = 1 + (int)rng_below(rng, 6);
    while (edits--) {
        size_t at = rng_below(rng, length + 1), count = 1 + rng_below(rng, 24);
        const char *word = words[rng_below(rng, sizeof words / sizeof *words)];
        size_t word_length = strlen(word);
        switch (rng_below(rng, 4)) {
        case 0: /* a byte becomes any byte */
            if (at < length)
                text[at] = (char)rng_next(rng);
            break;
        case 1: /* some are lost */
            count = at + count > length ? length - at : count;
            memmove(text + at, text + at + count, length - at - count);
            length -= count;
            break;
        case 2: /* some appear twice elsewhere */
            count = at + count > length ? length - at : count;
            if (length + count < SOURCE_MAX) {
                char copy[32];
                size_t to = rng_below(rng, length + 1);
                memcpy(copy, text + at, count);
                memmove(text + to + count, text + to, length - to);
                memcpy(text + to, copy, count);
                length += count;
            }
            break;
        default: /* a word of the language */
            if (length + word_length < SOURCE_MAX) {
                memmove(text + at + word_length, text + at, length - at);
                memcpy(text + at, word, word_length);
                length += word_length;
            }
        }
    }
    return length;
}

static const char *read_include(void *context, const char *name, size_t *length) {
    static const char text[] = "#define F(x, y) (x) * F(y, x)\n#include \"macros.h\"\n";
    *length = sizeof text - 1;
    return name[0] == 'm' ? text : NULL;
}

static int file_count;
static char **file_names;

static void mutated_shaders_end_in_success_or_a_message(void **state) {
    const char *count_text = getenv("FUZZ_ROUNDS");
    int rounds = count_text ? atoi(count_text) : 30000, compiled = 0;
    struct rng rng = {20240601};
    static char base[FILES_MAX][SOURCE_MAX], text[SOURCE_MAX];
    static size_t lengths[FILES_MAX];
    assert_true(file_count > 0 && file_count <= FILES_MAX);
    for (int i = 0; i < file_count; i++) {
        FILE *file = fopen(file_names[i], "rb");
        assert_non_null(file);
        lengths[i] = fread(base[i], 1, SOURCE_MAX / 2, file);
        fclose(file);
    }
    for (int round = 0; round < rounds; round++) {
        int which = (int)rng_below(&rng, (uint64_t)file_count);
        const char *const material[] = {"Cs", "Ka"};
        struct shader_compile_options options = {.material = material,
                                                 .material_count = (int)rng_below(&rng, 3),
                                                 .writes_source = round & 1,
                                                 .read_include = read_include};
        struct shader_program *program = NULL;
        struct status status = {0};
        memcpy(text, base[which], lengths[which]);
        size_t length = mutate(text, lengths[which], &rng);
        if (shader_compile("fuzz.sl", text, length, &options, &program, &status)) {
            compiled++;
            assert_true(program->c_length == strlen(program->c_source));
        } else {
            if (status.code == STATUS_INTERNAL || !status.message[0])
                fail_msg("round %d of %s: %s", round, file_names[which], status.message);
        }
        shader_program_destroy(program);
    }
    assert_true(compiled >
                rounds / 100); /* otherwise the mutations are too wild to test the passes */
}

int main(int count, char **names) {
    file_count = count - 1;
    file_names = names + 1;
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(mutated_shaders_end_in_success_or_a_message)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
