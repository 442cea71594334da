/* SPDX-License-Identifier: Apache-2.0 */
#include "nodes/shader_library.h"
#include "tests/test_harness.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

/* A folder of shaders on disk: what they include is found next to them, then in any folder. */

static void write_file(const char *folder, const char *name, const char *text) {
    char path[256];
    snprintf(path, sizeof path, "%s/%s", folder, name);
    FILE *file = fopen(path, "wb");
    assert_non_null(file);
    fputs(text, file);
    fclose(file);
}

static void included_files_are_found(void **state) {
    char root[] = "/tmp/sortlast-files-XXXXXX", near[128], far[128], command[160];
    assert_non_null(mkdtemp(root));
    snprintf(near, sizeof near, "%s/near", root);
    snprintf(far, sizeof far, "%s/far", root);
    assert_int_equal(mkdir(near, 0700), 0);
    assert_int_equal(mkdir(far, 0700), 0);
    write_file(near, "a.sl",
               "#include \"half.h\"\n#include \"third.h\"\nsurface a() { Ci = HALF + THIRD; }");
    write_file(near, "half.h", "#define HALF 0.5\n");
    write_file(far, "half.h", "#define HALF wrong\n");
    write_file(far, "third.h", "#define THIRD 0.25\n");
    write_file(near, "b.sl", "#include \"missing.h\"\nsurface b() { Ci = 1; }");
    const char *folders[2] = {far, near};
    struct shader_library *library = shader_library_create(folders, 2, &(struct shader_precision){0});
    const struct scene_location at = {"scene.rib", 1, 1};
    const struct shader_variant *variant;
    struct status status = {0};
    if (!shader_library_variant(library, &(struct shader_wanted){.name = "a"}, &at, &variant,
                                &status))
        fail_msg("%s", status.message);
    assert_false(shader_library_variant(library, &(struct shader_wanted){.name = "b"}, &at,
                                        &variant, &status));
    assert_non_null(
        strstr(status.message, "b.sl:1:10: error: cannot find \"missing.h\" to include"));
    shader_library_destroy(library);
    snprintf(command, sizeof command, "rm -r '%s'", root);
    assert_int_equal(system(command), 0);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(included_files_are_found)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
