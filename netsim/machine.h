/* SPDX-License-Identifier: Apache-2.0 */
#ifndef MACHINE_H
#define MACHINE_H

#include "base/simd_operations.h"
#include "base/status.h"
#include "base/ticks.h"
#include "netsim/machine_parameters.h"

#include <stdint.h>

/* A machine is data: rates, widths, latencies, memory sizes and the price of each SIMD operation.
 */
struct machine {
    char name[64];
#define MACHINE_FIELD(field, unit, minimum, maximum, what) int64_t field;
    MACHINE_PARAMETERS(MACHINE_FIELD)
#undef MACHINE_FIELD
    int64_t operation_ps[SIMD_OPERATION_COUNT]; /* once for the whole array */

    /* Derived by machine_derive: */
    struct tick_rate rate;
    ticks composition_word; /* one word over one composition link */
    ticks composition_hop;
    ticks geometry_word;
    ticks raster_triangle, raster_region, shading_region;
    ticks operation[SIMD_OPERATION_COUNT];
};

/* Number of entries in the flat form: all parameters, then all operation prices. */
enum {
#define MACHINE_COUNT(field, unit, minimum, maximum, what) MACHINE_INDEX_##field,
    MACHINE_PARAMETERS(MACHINE_COUNT)
#undef MACHINE_COUNT
        MACHINE_PARAMETER_COUNT,
    MACHINE_VALUE_COUNT = MACHINE_PARAMETER_COUNT + SIMD_OPERATION_COUNT
};

struct machine_parameter {
    const char *name; /* as in the JSON file; prices of operations end in _ps */
    const char *unit;
    int64_t minimum, maximum;
    const char *what;
};

/* The i-th of MACHINE_VALUE_COUNT entries of the schema, and its value in a machine. */
struct machine_parameter machine_parameter_at(int index);
int64_t machine_value(const struct machine *machine, int index);

/* Reads and checks a description; every entry must be there. Errors name the file and the entry. */
bool machine_read_file(const char *path, struct machine *machine, struct status *status);
bool machine_parse(const char *file, const char *text, struct machine *machine,
                   struct status *status);

/* The flat form that goes over the wire. machine_from_values checks ranges and derives. */
void machine_to_values(const struct machine *machine, int64_t values[MACHINE_VALUE_COUNT]);
bool machine_from_values(const char *name, const int64_t values[MACHINE_VALUE_COUNT],
                         struct machine *machine, struct status *status);

/* Samples of a region, and composition words a sample takes with `map_bytes` bytes of parameters
 * (the shader ID comes on top; FACTS: 28 payload bytes of every 32). At least one word. */
int64_t machine_region_samples(const struct machine *machine);
int64_t machine_map_words(const struct machine *machine, int64_t map_bytes);

#endif
