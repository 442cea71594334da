/* SPDX-License-Identifier: Apache-2.0 */
#include "nodes/programs/machine_command.h"

#include "netsim/machine.h"
#include "nodes/programs/calibrate.h"
#include "nodes/programs/render_options.h"

#include <cjson/cJSON.h>
#include <dirent.h>
#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static void print_help(void) {
    puts("usage: sortlast machine show [NAME|FILE]   every number with its unit and source "
         "(default pixelflow)\n"
         "       sortlast machine list               the descriptions that come with the program\n"
         "       sortlast machine check FILE         read and check a description; silent when it "
         "is good\n"
         "       sortlast machine calibrate [-q] [-o FILE.json] [SCENE.rib]\n"
         "                                           measure this host, one core a node, and write "
         "its description\n"
         "                                           (default host.json); with a scene, predict a "
         "frame on 1 + 1 nodes\n"
         "                                           by it and measure one\n"
         "\n"
         "docs/machines.md says how to write one.");
}

static int failure(const struct status *status) {
    fprintf(stderr, "sortlast: %s\n", status->message);
    return status_exit_code(status->code);
}

/* The file's text once more: sources are for people and not part of the machine. */
static cJSON *read_document(const char *path) {
    enum { BYTES_MAX = 1 << 20 };
    FILE *file = fopen(path, "rb");
    if (!file)
        return NULL;
    char *text = memory_get(BYTES_MAX + 1, 1);
    const size_t length = fread(text, 1, BYTES_MAX, file);
    fclose(file);
    text[length] = 0;
    cJSON *document = cJSON_Parse(text);
    free(text);
    return document;
}

static int show(const char *name) {
    struct machine machine;
    struct status status = {0};
    char path[4096];
    if (!machine_find_file(name, path, sizeof path, &status) ||
        !machine_read_file(path, &machine, &status))
        return failure(&status);
    cJSON *document = read_document(path);
    const cJSON *parameters = cJSON_GetObjectItemCaseSensitive(document, "parameters");
    printf("%s (%s), one tick is 1/%" PRIu64 " s\n\n", machine.name, path, machine.rate.per_s);
    printf("%-32s %16s  %-9s %-52s  %s\n", "parameter", "value", "unit", "what it is", "source");
    for (int i = 0; i < MACHINE_VALUE_COUNT; i++) {
        const struct machine_parameter parameter = machine_parameter_at(i);
        const cJSON *entry = cJSON_GetObjectItemCaseSensitive(parameters, parameter.name);
        const cJSON *source = cJSON_GetObjectItemCaseSensitive(entry, "source");
        printf("%-32s %16" PRId64 "  %-9s %-52s  %s\n", parameter.name, machine_value(&machine, i),
               parameter.unit, parameter.what, cJSON_IsString(source) ? source->valuestring : "");
    }
    cJSON_Delete(document);
    return 0;
}

static int compare_names(const void *a, const void *b) {
    return strcmp(*(char *const *)a, *(char *const *)b);
}

static int list(void) {
    char folder[4096], path[4096], **names = NULL;
    struct status status = {0};
    size_t count = 0, capacity = 0;
    if (!machine_find_file("pixelflow", path, sizeof path, &status))
        return failure(&status);
    snprintf(folder, sizeof folder, "%.*s", (int)(strrchr(path, '/') - path), path);
    DIR *directory = opendir(folder);
    for (struct dirent *entry; directory && (entry = readdir(directory));) {
        const char *suffix = strrchr(entry->d_name, '.');
        if (!suffix || strcmp(suffix, ".json"))
            continue;
        names = memory_grow(names, &capacity, count + 1, sizeof *names);
        names[count] = memory_copy_string(entry->d_name);
        names[count++][suffix - entry->d_name] = 0;
    }
    if (directory)
        closedir(directory);
    qsort(names, count, sizeof *names, compare_names);
    for (size_t i = 0; i < count; i++) {
        struct machine machine;
        if (machine_find_file(names[i], path, sizeof path, &status) &&
            machine_read_file(path, &machine, &status))
            printf("%-16s %s\n", names[i], machine.name);
        else
            printf("%-16s %s\n", names[i], status.message);
        free(names[i]);
    }
    free(names);
    return 0;
}

static int check(const char *path) {
    struct machine machine;
    struct status status = {0};
    return machine_read_file(path, &machine, &status) ? 0 : failure(&status);
}

int machine_main(int argc, char **argv) {
    const char *what = argc > 1 ? argv[1] : "";
    for (int i = 1; i < argc && i <= 2; i++) /* of the verb, or of what it does */
        if (!strcmp(argv[i], "--help") || !strcmp(argv[i], "-h")) {
            print_help();
            return 0;
        }
    if (!strcmp(what, "show") && argc <= 3)
        return show(argc == 3 ? argv[2] : "pixelflow");
    if (!strcmp(what, "list") && argc == 2)
        return list();
    if (!strcmp(what, "check") && argc == 3)
        return check(argv[2]);
    if (!strcmp(what, "calibrate"))
        return calibrate_main(argc - 1, argv + 1);
    fprintf(stderr, "sortlast: machine needs show, list, calibrate or check FILE (see sortlast "
                    "machine --help)\n");
    return 1;
}
