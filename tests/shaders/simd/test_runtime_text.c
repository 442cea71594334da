/* SPDX-License-Identifier: Apache-2.0 */
/* The embedded headers are complete: whatever one includes by name is another of them. */

#include "samples.h"

#include "shaders/simd/runtime_text.h"

#include <string.h>

static const struct runtime_file *find(const char *name, size_t length) {
    for (int i = 0; i < runtime_file_count; i++)
        if (strlen(runtime_files[i].name) == length &&
            memcmp(runtime_files[i].name, name, length) == 0)
            return &runtime_files[i];
    return NULL;
}

static void the_headers_a_shader_names_are_there(void **state) {
    assert_non_null(find("vector_math.h", strlen("vector_math.h")));
    assert_non_null(find("shader_module.h", strlen("shader_module.h")));
    for (int i = 0; i < runtime_file_count; i++) {
        assert_int_equal(strlen(runtime_files[i].text), runtime_files[i].length);
        assert_null(strchr(runtime_files[i].name, '/'));
    }
}

static void every_include_is_of_another_embedded_file(void **state) {
    const char include[] = "#include \"";
    int seen = 0;
    for (int i = 0; i < runtime_file_count; i++) {
        for (const char *at = runtime_files[i].text; (at = strstr(at, include)); seen++) {
            at += strlen(include);
            const char *end = strchr(at, '"');
            if (!find(at, (size_t)(end - at)))
                fail_msg("%s includes %.*s", runtime_files[i].name, (int)(end - at), at);
        }
    }
    assert_true(seen > 0);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_headers_a_shader_names_are_there),
        cmocka_unit_test(every_include_is_of_another_embedded_file),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
