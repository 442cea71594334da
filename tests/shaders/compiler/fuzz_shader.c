/* SPDX-License-Identifier: Apache-2.0 */
#include "shaders/compiler/shader_compile.h"

#include <stdio.h>
#include <stdlib.h>

/* Any bytes are a shader or an error. With libFuzzer the engine brings main; without, main replays
 * the files named on the command line. */

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t length);

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t length) {
    static const char *const material[] = {"Cs"};
    static struct shader_fixing fixings[256];
    for (size_t i = 0; i < sizeof fixings / sizeof *fixings; i++)
        fixings[i] = (struct shader_fixing){true, -2, 2, 8 * (int)(i % 5)};
    struct shader_compile_options options = {.material = material,
                                             .material_count = length & 1,
                                             .fast_math = (length & 2) != 0,
                                             .writes_source = (length & 4) != 0,
                                             .fixings = fixings,
                                             .fixing_count =
                                                 length & 8 ? sizeof fixings / sizeof *fixings : 0};
    struct shader_program *program = NULL;
    struct status status = {0};
    if (!shader_compile("fuzz.sl", (const char *)bytes, length, &options, &program, &status) &&
        status.code == STATUS_INTERNAL) {
        fprintf(stderr, "%s\n", status.message);
        abort();
    }
    shader_program_destroy(program);
    return 0;
}

#ifndef FUZZ_WITH_ENGINE
int main(int count, char **names) {
    static uint8_t bytes[(1 << 20) + 16];
    for (int i = 1; i < count; i++) {
        FILE *file = fopen(names[i], "rb");
        if (!file) {
            fprintf(stderr, "cannot open %s\n", names[i]);
            return 1;
        }
        size_t length = fread(bytes, 1, sizeof bytes, file);
        fclose(file);
        LLVMFuzzerTestOneInput(bytes, length);
    }
    return 0;
}
#endif
