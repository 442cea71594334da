/* SPDX-License-Identifier: Apache-2.0 */
#include "netsim/what_if.h"

#include "netsim/distribution.h"

#include <stdlib.h>
#include <string.h>

/* Raster work of one frame's regions by node: depends on distribution alone. */
struct frame_layout {
    struct timing_region *regions; /* with work; costs are filled in for each solution */
    struct timing_work *work;
    uint32_t *shading_node;
    uint32_t *map_bytes; /* [instance] */
    uint32_t *vertices;  /* [chunk] that come with it besides those of its group before it */
};

struct what_if_solver {
    const struct run_record *record;
    struct frame_layout *layouts;
    struct what_if_frame *frames;
    struct {
        uint32_t rendering_nodes, chunk_triangles;
        uint64_t seed;
    } distributed;   /* what the layouts were made for; no nodes: nothing yet */
    uint32_t *place; /* [node] its work entry in the region at hand, plus 1 */
    uint32_t place_count;
};

struct what_if what_if_default(const struct run_record *record) {
    return (struct what_if){.machine = record->machine,
                            .strategy = strategy_at(0),
                            .rendering_nodes = 1,
                            .shading_nodes = 1,
                            .seed = record->seed};
}

struct what_if_solver *what_if_solver_create(const struct run_record *record) {
    struct what_if_solver *solver = memory_get(1, sizeof *solver);
    solver->record = record;
    solver->layouts = memory_get(record->frame_count, sizeof *solver->layouts);
    solver->frames = memory_get(record->frame_count, sizeof *solver->frames);
    for (uint32_t f = 0; f < record->frame_count; f++) {
        const struct record_frame *frame = &record->frames[f];
        struct frame_layout *layout = &solver->layouts[f];
        layout->regions = memory_get(frame->region_count, sizeof *layout->regions);
        layout->work = memory_get(frame->entry_count, sizeof *layout->work);
        layout->shading_node = memory_get(frame->region_count, sizeof *layout->shading_node);
        layout->map_bytes = memory_get(frame->instance_count, sizeof *layout->map_bytes);
        layout->vertices = memory_get(frame->chunk_count, sizeof *layout->vertices);
    }
    return solver;
}

void what_if_solver_destroy(struct what_if_solver *solver) {
    if (!solver)
        return;
    for (uint32_t f = 0; f < solver->record->frame_count; f++) {
        free(solver->layouts[f].regions);
        free(solver->layouts[f].work);
        free(solver->layouts[f].shading_node);
        free(solver->layouts[f].map_bytes);
        free(solver->layouts[f].vertices);
    }
    free(solver->layouts);
    free(solver->frames);
    free(solver->place);
    free(solver);
}

/* Numbers the groups of chunks that would be one chunk of so many triangles; returns how many.
 * Vertices that a chunk has in common with those of its group before it come once. */
static uint32_t group_chunks(const struct record_frame *frame, uint32_t chunk_triangles,
                             uint32_t *group, uint32_t *vertices) {
    uint32_t count = 0, first = 0;
    uint64_t triangles = 0;
    for (uint32_t c = 0; c < frame->chunk_count; c++) {
        const struct record_chunk *chunk = &frame->chunks[c];
        triangles += chunk->triangles;
        if (chunk->begins_run || triangles > chunk_triangles) {
            count++;
            triangles = chunk->triangles;
            first = c;
        }
        group[c] = count - 1;
        vertices[c] = chunk->vertices;
        for (uint32_t s = 0; s < chunk->sharing_count; s++) {
            const struct record_sharing *sharing = &frame->sharing[chunk->first_sharing + s];
            vertices[c] -= sharing->distance <= c - first ? sharing->vertices : 0;
        }
    }
    return count;
}

static int compare_nodes(const void *a, const void *b) {
    const uint32_t x = ((const struct timing_work *)a)->node,
                   y = ((const struct timing_work *)b)->node;
    return x < y ? -1 : x > y;
}

/* Adds up the chunks of each region by the node that has them. */
static void distribute_frame(struct what_if_solver *solver, const struct record_frame *frame,
                             struct frame_layout *layout, const struct what_if *question) {
    uint32_t *group = memory_get(frame->chunk_count, sizeof *group);
    const uint32_t groups = group_chunks(frame, question->chunk_triangles, group, layout->vertices);
    uint32_t *node = distribution_assign(groups, question->rendering_nodes, question->seed);
    struct timing_work *work = layout->work;
    for (uint32_t k = 0; k < frame->region_count; k++) {
        const struct record_region *region = &frame->regions[k];
        uint32_t count = 0;
        for (uint32_t e = 0; e < region->entry_count; e++) {
            const struct record_entry *entry = &frame->entries[region->first_entry + e];
            const uint32_t i = node[group[entry->chunk]];
            if (!solver->place[i]) {
                work[count] = (struct timing_work){i, 0};
                solver->place[i] = ++count;
            }
            work[solver->place[i] - 1].triangles += entry->triangles;
        }
        for (uint32_t w = 0; w < count; w++)
            solver->place[work[w].node] = 0;
        qsort(work, count, sizeof *work, compare_nodes);
        layout->regions[k].work = work;
        layout->regions[k].work_count = count;
        work += count;
    }
    free(group);
    free(node);
}

static void distribute(struct what_if_solver *solver, const struct what_if *question) {
    if (solver->distributed.rendering_nodes == question->rendering_nodes &&
        solver->distributed.seed == question->seed &&
        solver->distributed.chunk_triangles == question->chunk_triangles)
        return;
    if (solver->place_count < question->rendering_nodes) {
        free(solver->place);
        solver->place = memory_get(question->rendering_nodes, sizeof *solver->place);
        solver->place_count = question->rendering_nodes;
    }
    for (uint32_t f = 0; f < solver->record->frame_count; f++)
        distribute_frame(solver, &solver->record->frames[f], &solver->layouts[f], question);
    solver->distributed.rendering_nodes = question->rendering_nodes;
    solver->distributed.seed = question->seed;
    solver->distributed.chunk_triangles = question->chunk_triangles;
}

static bool is_bound_now(const struct record_instance *instance,
                         const struct record_parameter *parameter, const struct what_if *question) {
    for (size_t b = 0; b < question->bind_count; b++)
        if (!strcmp(question->binds[b].instance, instance->name) &&
            !strcmp(question->binds[b].parameter, parameter->name))
            return true;
    return false;
}

static bool travels(const struct record_instance *instance,
                    const struct record_parameter *parameter, const struct what_if *question) {
    if (parameter->use == RECORD_MATERIAL)
        return !is_bound_now(instance, parameter, question);
    return parameter->use == RECORD_BOUND && (question->maps & WHAT_IF_MAPS_UNBOUND);
}

/* Does an earlier parameter of the frame, of the same name and no shorter, travel already? */
static bool is_in_union(const struct record_frame *frame, uint32_t i, uint32_t p,
                        const struct what_if *question) {
    const struct record_parameter *parameter = &frame->instances[i].parameters[p];
    for (uint32_t j = 0; j <= i; j++) {
        const struct record_instance *instance = &frame->instances[j];
        for (uint32_t q = 0; q < (j < i ? instance->parameter_count : p); q++)
            if (!strcmp(instance->parameters[q].name, parameter->name) &&
                instance->parameters[q].bytes >= parameter->bytes &&
                travels(instance, &instance->parameters[q], question))
                return true;
    }
    return false;
}

static uint32_t own_floats(const struct record_instance *instance, const struct what_if *question) {
    uint32_t floats = 0;
    for (uint32_t p = 0; p < instance->parameter_count; p++)
        if (travels(instance, &instance->parameters[p], question))
            floats += instance->parameters[p].floats;
    return floats;
}

static uint32_t own_bytes(const struct record_instance *instance, const struct what_if *question) {
    uint32_t bytes = 0;
    for (uint32_t p = 0; p < instance->parameter_count; p++)
        if (travels(instance, &instance->parameters[p], question))
            bytes += instance->parameters[p].bytes;
    return bytes;
}

static uint32_t union_bytes(const struct record_frame *frame, const struct what_if *question) {
    uint32_t bytes = 0;
    for (uint32_t i = 0; i < frame->instance_count; i++)
        for (uint32_t p = 0; p < frame->instances[i].parameter_count; p++)
            if (travels(&frame->instances[i], &frame->instances[i].parameters[p], question) &&
                !is_in_union(frame, i, p, question))
                bytes += frame->instances[i].parameters[p].bytes;
    return bytes;
}

uint32_t what_if_map_bytes(const struct record_frame *frame, uint32_t instance,
                           const struct what_if *question) {
    enum { POSITION_BYTES = 12 };
    return (question->maps & WHAT_IF_MAPS_UNION
                ? union_bytes(frame, question)
                : own_bytes(&frame->instances[instance], question)) +
           (question->maps & WHAT_IF_MAPS_POSITION ? POSITION_BYTES : 0);
}

/* What the geometry network carries: with other maps vertices of more or fewer floats, and newly
 * bound parameters once; with other chunks fewer vertices. */
static uint64_t geometry_bytes(const struct record_frame *frame, const uint32_t *vertices,
                               const struct what_if *question) {
    uint64_t bytes = 0, bound = 0;
    for (int cause = 0; cause < CAUSE_COUNT; cause++)
        bytes += frame->geometry_bytes[cause];
    if (question->assignment == WHAT_IF_BY_COST)
        bytes += WHAT_IF_ASSIGNMENT_BYTES * (uint64_t)frame->region_count;
    if (!question->bind_count && !(question->maps & WHAT_IF_MAPS_UNBOUND) &&
        !question->chunk_triangles)
        return bytes;
    uint32_t *recorded = memory_get(frame->instance_count, sizeof *recorded),
             *floats = memory_get(frame->instance_count, sizeof *floats);
    for (uint32_t i = 0; i < frame->instance_count; i++) {
        const struct record_instance *instance = &frame->instances[i];
        recorded[i] = record_instance_floats(instance, RECORD_MATERIAL);
        floats[i] = own_floats(instance, question);
        for (uint32_t p = 0; p < instance->parameter_count; p++)
            if (instance->parameters[p].use == RECORD_MATERIAL &&
                is_bound_now(instance, &instance->parameters[p], question))
                bound += 4 * (uint64_t)instance->parameters[p].floats;
    }
    bytes = bytes - record_primitive_bytes(frame, recorded, NULL) +
            record_primitive_bytes(frame, floats, vertices) + bound;
    free(recorded);
    free(floats);
    return bytes;
}

/* The operation that is issued for one of the record under another choice of functions. */
static int repriced(int operation, enum what_if_math math) {
    if (math == WHAT_IF_MATH_FAST)
        return simd_operation_fast(operation);
    if (math == WHAT_IF_MATH_EXACT)
        for (int exact = 0; exact < SIMD_OPERATION_COUNT; exact++)
            if (exact != operation && simd_operation_fast(exact) == operation)
                return exact;
    return operation;
}

/* What the array is charged under a question. */
struct prices {
    ticks operation[SIMD_OPERATION_COUNT];
    const ticks *loading; /* [instance] newly bound parameters into pixel memory, a region; NULL */
};

static void price_operations(const struct what_if *question, struct prices *prices) {
    for (int operation = 0; operation < SIMD_OPERATION_COUNT; operation++)
        prices->operation[operation] =
            question->machine.operation[repriced(operation, question->math)];
}

/* A bound varying parameter is loaded into the pixels once a region, a move for each float. */
static ticks *price_loading(const struct record_frame *frame, const struct what_if *question,
                            const struct prices *prices) {
    if (!question->bind_count)
        return NULL;
    ticks *loading = memory_get(frame->instance_count, sizeof *loading);
    for (uint32_t i = 0; i < frame->instance_count; i++) {
        const struct record_instance *instance = &frame->instances[i];
        for (uint32_t p = 0; p < instance->parameter_count; p++)
            if (instance->parameters[p].use == RECORD_MATERIAL &&
                is_bound_now(instance, &instance->parameters[p], question))
                loading[i] =
                    ticks_add(loading[i], ticks_multiply(prices->operation[SIMD_FLOAT_MOVE],
                                                         instance->parameters[p].floats));
    }
    return loading;
}

static ticks work_of(const struct record_frame *frame, const struct record_work *work,
                     const struct prices *prices) {
    ticks total =
        prices->loading && work->shader < RECORD_SHARED ? prices->loading[work->shader - 1] : 0;
    for (uint32_t o = 0; o < work->operation_count; o++) {
        const struct record_operation *operation = &frame->operations[work->first_operation + o];
        total = ticks_add(total, operation->count > INT64_MAX
                                     ? TICKS_MAX
                                     : ticks_multiply(prices->operation[operation->operation],
                                                      (int64_t)operation->count));
    }
    return total;
}

static ticks shading_of(const struct record_frame *frame, const struct record_region *region,
                        const struct what_if *question, const struct prices *prices) {
    ticks total = region->work_count ? question->machine.shading_region : 0;
    for (uint32_t w = 0; w < region->work_count; w++) {
        const struct record_work *work = &frame->works[region->first_work + w];
        if (work->shader != RECORD_SHARED || !(question->maps & WHAT_IF_MAPS_POSITION))
            total = ticks_add(total, work_of(frame, work, prices));
    }
    return total;
}

ticks what_if_longest_shading(const struct record_frame *frame, uint32_t instance,
                              const struct what_if *question) {
    struct prices prices = {.loading = NULL};
    price_operations(question, &prices);
    ticks *loading = price_loading(frame, question, &prices), longest = 0;
    prices.loading = loading;
    for (uint32_t w = 0; w < frame->work_count; w++)
        if (frame->works[w].shader == instance + 1)
            longest = ticks_max(longest, work_of(frame, &frame->works[w], &prices));
    free(loading);
    return longest;
}

ticks what_if_shading(const struct record_frame *frame, const struct record_region *region,
                      const struct what_if *question) {
    struct prices prices = {.loading = NULL};
    price_operations(question, &prices);
    ticks *loading = price_loading(frame, question, &prices);
    prices.loading = loading;
    const ticks total = shading_of(frame, region, question, &prices);
    free(loading);
    return total;
}

static int64_t longest_map(const struct record_frame *frame, const struct record_region *region,
                           const uint32_t *map_bytes, bool is_union) {
    uint32_t longest = is_union && frame->instance_count ? map_bytes[0] : 0;
    for (uint32_t e = 0; e < region->entry_count; e++) {
        const struct record_entry *entry = &frame->entries[region->first_entry + e];
        const uint32_t bytes = map_bytes[frame->chunks[entry->chunk].instance - 1];
        if (entry->covers && bytes > longest)
            longest = bytes;
    }
    return longest;
}

/* To the node with the least shading so far, the lower number of several. */
static uint32_t give_to_least(ticks *load, uint32_t shading_nodes, ticks shading) {
    uint32_t least = 0;
    for (uint32_t j = 1; j < shading_nodes; j++)
        if (load[j] < load[least])
            least = j;
    load[least] = ticks_add(load[least], shading);
    return least;
}

void what_if_assign(const struct run_record *record, uint32_t f, const struct machine *machine,
                    uint32_t shading_nodes, uint32_t *node) {
    const struct record_frame *frame =
        &record->frames[f < record->frame_count ? f : record->frame_count - 1];
    struct what_if question = what_if_default(record);
    struct prices prices = {.loading = NULL};
    ticks *load = memory_get(shading_nodes, sizeof *load);
    question.machine = *machine;
    price_operations(&question, &prices);
    for (uint32_t k = 0; k < frame->region_count; k++)
        node[k] = give_to_least(load, shading_nodes,
                                shading_of(frame, &frame->regions[k], &question, &prices));
    free(load);
}

static bool check_machine(const struct run_record *record, const struct machine *machine,
                          struct status *status) {
    if (machine->region_width == record->machine.region_width &&
        machine->region_height == record->machine.region_height)
        return true;
    return status_fail(status, STATUS_INVALID,
                       "the record holds regions of %lld x %lld samples, machine %s has %lld x "
                       "%lld: record a run with that machine",
                       (long long)record->machine.region_width,
                       (long long)record->machine.region_height, machine->name,
                       (long long)machine->region_width, (long long)machine->region_height);
}

bool what_if_can_assign(const struct run_record *record, uint32_t f, const struct machine *machine,
                        uint32_t region_count, struct status *status) {
    if (!record->frame_count)
        return status_fail(status, STATUS_INVALID, "the record of costs holds no frame");
    const struct record_frame *frame =
        &record->frames[f < record->frame_count ? f : record->frame_count - 1];
    return check_machine(record, machine, status) &&
           (frame->region_count == region_count ||
            status_fail(status, STATUS_INVALID,
                        "the record of costs has %u regions in frame %d, but here are %u: record "
                        "a run of a picture of this size",
                        frame->region_count, frame->number, region_count));
}

static void assign_by_cost(const struct record_frame *frame, uint32_t f,
                           struct frame_layout *layout, const struct what_if *question) {
    if (question->costs) {
        what_if_assign(question->costs, f, &question->machine, question->shading_nodes,
                       layout->shading_node);
        return;
    }
    ticks *load = memory_get(question->shading_nodes, sizeof *load);
    for (uint32_t k = 0; k < frame->region_count; k++)
        layout->shading_node[k] =
            give_to_least(load, question->shading_nodes, layout->regions[k].shading);
    free(load);
}

/* Fills in what depends on machine, maps and functions. */
static void price_frame(struct what_if_solver *solver, uint32_t f, const struct what_if *question,
                        const struct prices *base, struct what_if_frame *result) {
    const struct record_frame *frame = &solver->record->frames[f];
    struct frame_layout *layout = &solver->layouts[f];
    const struct machine *machine = &question->machine;
    for (uint32_t i = 0; i < frame->instance_count; i++)
        layout->map_bytes[i] = i && (question->maps & WHAT_IF_MAPS_UNION)
                                   ? layout->map_bytes[0]
                                   : what_if_map_bytes(frame, i, question);
    struct prices prices = *base;
    ticks *loading = price_loading(frame, question, base);
    prices.loading = loading;
    *result =
        (struct what_if_frame){.geometry_bytes = geometry_bytes(frame, layout->vertices, question)};
    for (uint32_t k = 0; k < frame->region_count; k++) {
        const struct record_region *region = &frame->regions[k];
        struct timing_region *timing = &layout->regions[k];
        timing->words = 0;
        timing->shading = 0;
        if (region->samples) {
            timing->words = (uint32_t)machine_map_words(
                machine,
                longest_map(frame, region, layout->map_bytes, question->maps & WHAT_IF_MAPS_UNION));
            timing->shading = shading_of(frame, region, question, &prices);
            result->regions_covered++;
        }
    }
    free(loading);
    if (question->assignment == WHAT_IF_BY_COST)
        assign_by_cost(frame, f, layout, question);
}

static ticks longest(const ticks *times, uint32_t count) {
    ticks most = 0;
    for (uint32_t i = 0; i < count; i++)
        most = ticks_max(most, times[i]);
    return most;
}

/* Busy longest over all frames; ties go to the first listed. */
static enum timing_resource bound_of(const struct what_if_result *result) {
    ticks busy[TIMING_RESOURCE_COUNT] = {0};
    for (uint32_t f = 0; f < result->frame_count; f++) {
        const struct what_if_frame *frame = &result->frames[f];
        busy[TIMING_COMPOSITION] =
            ticks_add(busy[TIMING_COMPOSITION], frame->times.composition_busy);
        busy[TIMING_GEOMETRY] = ticks_add(busy[TIMING_GEOMETRY], frame->times.geometry_busy);
        busy[TIMING_RASTER] = ticks_add(busy[TIMING_RASTER], frame->raster_longest);
        busy[TIMING_SHADING] = ticks_add(busy[TIMING_SHADING], frame->shading_longest);
        busy[TIMING_FRAMEBUFFER] =
            ticks_add(busy[TIMING_FRAMEBUFFER], frame->times.framebuffer_busy);
    }
    enum timing_resource most = TIMING_COMPOSITION;
    for (int resource = 0; resource < TIMING_RESOURCE_COUNT; resource++)
        if (busy[resource] > busy[most])
            most = (enum timing_resource)resource;
    return most;
}

static bool check_chunks(const struct run_record *record, uint32_t chunk_triangles,
                         struct status *status) {
    if (chunk_triangles % record->chunk_triangles == 0)
        return true;
    return status_fail(status, STATUS_INVALID,
                       "the record holds chunks of %u triangles, from which chunks of %u cannot be "
                       "put together: record a run with --chunk-triangles %u, or a divisor of it",
                       record->chunk_triangles, chunk_triangles, chunk_triangles);
}

bool what_if_solve(struct what_if_solver *solver, const struct what_if *question,
                   struct timeline *timeline, struct what_if_result *result,
                   struct status *status) {
    const struct run_record *record = solver->record;
    struct prices prices = {.loading = NULL};
    if (!check_machine(record, &question->machine, status) ||
        !check_chunks(record, question->chunk_triangles, status))
        return false;
    for (uint32_t f = 0; question->costs && f < record->frame_count; f++)
        if (!what_if_can_assign(question->costs, f, &question->machine,
                                record->frames[f].region_count, status))
            return false;
    price_operations(question, &prices);
    distribute(solver, question);
    struct timing_model *model = timing_model_create(
        &question->machine, question->strategy, question->rendering_nodes, question->shading_nodes);
    timing_model_record(model, timeline);
    *result = (struct what_if_result){.frames = solver->frames, .frame_count = record->frame_count};
    bool ok = true;
    for (uint32_t f = 0; ok && f < record->frame_count; f++) {
        struct what_if_frame *frame = &solver->frames[f];
        price_frame(solver, f, question, &prices, frame);
        const struct timing_frame costs = {.geometry_bytes = frame->geometry_bytes,
                                           .regions = solver->layouts[f].regions,
                                           .region_count = record->frames[f].region_count,
                                           .shading_node = question->assignment == WHAT_IF_BY_COST
                                                               ? solver->layouts[f].shading_node
                                                               : NULL};
        ok = timing_model_add_frame(model, &costs, &frame->times, status);
        if (!ok)
            break;
        frame->raster_longest = longest(frame->times.raster_busy, question->rendering_nodes);
        frame->shading_longest = longest(frame->times.shading_busy, question->shading_nodes);
        frame->times.raster_busy = frame->times.shading_busy = NULL;
        result->end = frame->times.end;
    }
    timing_model_destroy(model);
    result->bound_by = bound_of(result);
    return ok;
}
