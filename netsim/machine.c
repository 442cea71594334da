/* SPDX-License-Identifier: Apache-2.0 */
#include "netsim/machine.h"

#include <cjson/cJSON.h>
#include <errno.h>
#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define PS_PER_S 1000000000000u
#define OPERATION_PS_MAX 1000000000000

struct machine_parameter machine_parameter_at(int index) {
    static const struct machine_parameter entries[MACHINE_VALUE_COUNT] = {
#define MACHINE_ENTRY(field, unit, minimum, maximum, what) {#field, unit, minimum, maximum, what},
        MACHINE_PARAMETERS(MACHINE_ENTRY)
#undef MACHINE_ENTRY
#define OPERATION_ENTRY(name, key, what) {key "_ps", "ps", 0, OPERATION_PS_MAX, what},
            SIMD_OPERATIONS(OPERATION_ENTRY)
#undef OPERATION_ENTRY
    };
    return entries[index];
}

void machine_to_values(const struct machine *machine, int64_t values[MACHINE_VALUE_COUNT]) {
    int i = 0;
#define MACHINE_STORE(field, unit, minimum, maximum, what) values[i++] = machine->field;
    MACHINE_PARAMETERS(MACHINE_STORE)
#undef MACHINE_STORE
    for (int operation = 0; operation < SIMD_OPERATION_COUNT; operation++)
        values[i++] = machine->operation_ps[operation];
}

int64_t machine_value(const struct machine *machine, int index) {
    int64_t values[MACHINE_VALUE_COUNT];
    machine_to_values(machine, values);
    return values[index];
}

static bool derive_ticks(struct machine *machine, struct status *status) {
    enum { PARAMETERS = 6 }; /* that are durations, before the operations */
    struct tick_rate rate = {1};
    const uint64_t word = (uint64_t)machine->composition_word_bytes;
    const uint64_t geometry_word = (uint64_t)machine->geometry_word_bytes;
    const uint64_t composition_rate = (uint64_t)machine->composition_bytes_per_s;
    const uint64_t geometry_rate = (uint64_t)machine->geometry_bytes_per_s;
    struct {
        uint64_t numerator, denominator;
        ticks *target;
    } durations[PARAMETERS + SIMD_OPERATION_COUNT] = {
        {word, composition_rate, &machine->composition_word},
        {geometry_word, geometry_rate, &machine->geometry_word},
        {(uint64_t)machine->composition_hop_latency_ps, PS_PER_S, &machine->composition_hop},
        {(uint64_t)machine->raster_triangle_ps, PS_PER_S, &machine->raster_triangle},
        {(uint64_t)machine->raster_region_ps, PS_PER_S, &machine->raster_region},
        {(uint64_t)machine->shading_region_ps, PS_PER_S, &machine->shading_region},
    };
    for (int i = 0; i < SIMD_OPERATION_COUNT; i++) {
        durations[PARAMETERS + i].numerator = (uint64_t)machine->operation_ps[i];
        durations[PARAMETERS + i].denominator = PS_PER_S;
        durations[PARAMETERS + i].target = &machine->operation[i];
    }
    for (size_t i = 0; i < sizeof durations / sizeof *durations; i++)
        if (durations[i].numerator &&
            !tick_rate_include(&rate, durations[i].numerator, durations[i].denominator, status))
            return status_prefix(status, "machine %s", machine->name);
    for (size_t i = 0; i < sizeof durations / sizeof *durations; i++)
        if (!ticks_from_seconds(rate, durations[i].numerator, durations[i].denominator,
                                durations[i].target, status))
            return status_prefix(status, "machine %s", machine->name);
    machine->rate = rate;
    return true;
}

bool machine_from_values(const char *name, const int64_t values[MACHINE_VALUE_COUNT],
                         struct machine *machine, struct status *status) {
    *machine = (struct machine){0};
    snprintf(machine->name, sizeof machine->name, "%s", name);
    for (int i = 0; i < MACHINE_VALUE_COUNT; i++) {
        struct machine_parameter parameter = machine_parameter_at(i);
        if (values[i] < parameter.minimum || values[i] > parameter.maximum)
            return status_fail(status, STATUS_INVALID,
                               "machine %s: %s is %" PRId64 " %s, but must lie in %" PRId64
                               " .. %" PRId64 " (%s)",
                               machine->name, parameter.name, values[i], parameter.unit,
                               parameter.minimum, parameter.maximum, parameter.what);
    }
    int i = 0;
#define MACHINE_LOAD(field, unit, minimum, maximum, what) machine->field = values[i++];
    MACHINE_PARAMETERS(MACHINE_LOAD)
#undef MACHINE_LOAD
    for (int operation = 0; operation < SIMD_OPERATION_COUNT; operation++)
        machine->operation_ps[operation] = values[i++];
    if (machine->composition_word_bytes <= machine->composition_depth_bytes)
        return status_fail(status, STATUS_INVALID,
                           "machine %s: composition_word_bytes leaves no room beside the depth",
                           machine->name);
    if (machine->region_width % 2 || machine->region_height % 2)
        return status_fail(
            status, STATUS_INVALID,
            "machine %s: region_width and region_height must be even, so that the 2 x "
            "2 samples of a derivative lie in one region",
            machine->name);
    return derive_ticks(machine, status);
}

static int parameter_index(const char *name) {
    for (int i = 0; i < MACHINE_VALUE_COUNT; i++)
        if (!strcmp(machine_parameter_at(i).name, name))
            return i;
    return -1;
}

static bool read_entry(const char *file, const cJSON *entry, int64_t values[MACHINE_VALUE_COUNT],
                       bool found[MACHINE_VALUE_COUNT], struct status *status) {
    int index = parameter_index(entry->string);
    if (index < 0)
        return status_fail(
            status, STATUS_INVALID,
            "%s: unknown parameter \"%s\"; `sortlast machine show` lists the known ones", file,
            entry->string);
    if (found[index])
        return status_fail(status, STATUS_INVALID, "%s: \"%s\" is given twice", file,
                           entry->string);
    const cJSON *value = cJSON_GetObjectItemCaseSensitive(entry, "value");
    const cJSON *source = cJSON_GetObjectItemCaseSensitive(entry, "source");
    /* Whole numbers below 2^53 are exact in the JSON reader's doubles; anything else is refused
     * here. */
    if (!cJSON_IsNumber(value) || value->valuedouble != floor(value->valuedouble) ||
        !(fabs(value->valuedouble) < 9007199254740992.0))
        return status_fail(status, STATUS_INVALID,
                           "%s: \"%s\" needs a \"value\" that is a whole number of %s below 2^53",
                           file, entry->string, machine_parameter_at(index).unit);
    if (!cJSON_IsString(source))
        return status_fail(
            status, STATUS_INVALID,
            "%s: \"%s\" needs a \"source\": where the number comes from (\"published: "
            "...\", \"derived: ...\" or \"ours: ...\")",
            file, entry->string);
    values[index] = (int64_t)value->valuedouble;
    found[index] = true;
    return true;
}

static bool read_document(const char *file, const cJSON *document, struct machine *machine,
                          struct status *status) {
    const cJSON *name = cJSON_GetObjectItemCaseSensitive(document, "name");
    const cJSON *parameters = cJSON_GetObjectItemCaseSensitive(document, "parameters");
    if (!cJSON_IsString(name) || !cJSON_IsObject(parameters))
        return status_fail(status, STATUS_INVALID,
                           "%s: a machine description has a \"name\" and an object \"parameters\"",
                           file);
    int64_t values[MACHINE_VALUE_COUNT] = {0};
    bool found[MACHINE_VALUE_COUNT] = {false};
    const cJSON *entry;
    cJSON_ArrayForEach(entry, parameters) {
        if (!read_entry(file, entry, values, found, status))
            return false;
    }
    for (int i = 0; i < MACHINE_VALUE_COUNT; i++)
        if (!found[i])
            return status_fail(status, STATUS_INVALID,
                               "%s: parameter \"%s\" is missing (%s, in %s)", file,
                               machine_parameter_at(i).name, machine_parameter_at(i).what,
                               machine_parameter_at(i).unit);
    if (!machine_from_values(name->valuestring, values, machine, status))
        return status_prefix(status, "%s", file);
    return true;
}

bool machine_parse(const char *file, const char *text, struct machine *machine,
                   struct status *status) {
    const char *end = NULL;
    cJSON *document = cJSON_ParseWithOpts(text, &end, 1);
    if (!document) {
        int line = 1, column = 1;
        for (const char *at = text; end && at < end; at++) {
            column = *at == '\n' ? 1 : column + 1;
            line += *at == '\n';
        }
        return status_fail(status, STATUS_INVALID, "%s:%d:%d: error: not valid JSON", file, line,
                           column);
    }
    bool ok = read_document(file, document, machine, status);
    cJSON_Delete(document);
    return ok;
}

bool machine_read_file(const char *path, struct machine *machine, struct status *status) {
    enum { MACHINE_FILE_BYTES_MAX = 1 << 20 };
    FILE *file = fopen(path, "rb");
    if (!file)
        return status_fail(status, STATUS_NOT_FOUND, "cannot open machine description %s: %s", path,
                           strerror(errno));
    char *text = memory_get(MACHINE_FILE_BYTES_MAX + 1, 1);
    size_t length = fread(text, 1, MACHINE_FILE_BYTES_MAX, file);
    bool ok = !ferror(file) && feof(file);
    fclose(file);
    if (ok)
        ok = machine_parse(path, text, machine, status);
    else
        status_fail(status, STATUS_INVALID,
                    "%s: cannot be read, or is longer than %d bytes (%zu read)", path,
                    MACHINE_FILE_BYTES_MAX, length);
    free(text);
    return ok;
}

int64_t machine_region_samples(const struct machine *machine) {
    return machine->region_width * machine->region_height;
}

int64_t machine_map_words(const struct machine *machine, int64_t map_bytes) {
    int64_t payload = machine->composition_word_bytes - machine->composition_depth_bytes;
    int64_t bytes = machine->composition_shader_id_bytes + map_bytes;
    return (bytes + payload - 1) / payload;
}
