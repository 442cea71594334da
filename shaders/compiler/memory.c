/* SPDX-License-Identifier: Apache-2.0 */
#include "shaders/compiler/memory.h"
#include "shaders/compiler/passes.h"

#include <stdlib.h>
#include <string.h>

/* Pixel memory as one large register file (PF section 6.3.3): a linear pass gives every varying
 * variable a place when it is first assigned and takes it back at its last use.
 *
 * Instructions are numbered in the order in which the array runs them, stream by stream. The
 * illuminance bodies together run once per light, so they form one loop. What is declared outside a
 * loop and touched inside it lives through the whole loop. Parameters, position and what the lights
 * leave have places of their own and are not counted here. When the rest does not fit, variables
 * are spilled to texture memory (memory_spill.c). */

enum {
    POSITION_BYTES = 12,
    LIGHT_BYTES = 25,   /* colour, direction, whether it is lit */
    AMBIENT_BYTES = 12, /* sum of the ambient lights */
    SHARED_BYTES = 52,  /* what shared_phong is given, and its result */
    DEFAULT_BYTES = 256,
};

int memory_variable_bytes(const struct ir_variable *variable) {
    const int one = variable->type == IR_BOOL    ? 1
                    : variable->type == IR_FIXED ? fixed_bytes(variable->format)
                                                 : 4;
    return one * (variable->array_length ? variable->array_length : 1);
}

/* Copies of what lies elsewhere in pixel memory: parameters, position, results of lights. */
static bool is_alias(const struct ir_variable *variable) {
    const struct ir_node *node = variable->definition;
    if (variable->definition_count != 1 || !node || node->kind != NODE_INSTRUCTION)
        return false;
    switch (node->operation) {
    case IR_MATERIAL:
    case IR_POSITION:
    case IR_INCIDENT:
    case IR_LIGHT_DIRECTION:
    case IR_LIGHT_COLOR:
        return true;
    default:
        return node->is_free;
    }
}

struct memory_range *memory_range_of(struct memory_plan *plan, const struct ir_variable *variable) {
    return &plan->ranges[variable->id];
}

struct touch {
    struct memory_plan *plan;
    struct ir_node *node;
};

static void touch(struct ir_variable *variable, void *context) {
    struct touch *t = context;
    struct memory_plan *plan = t->plan;
    struct memory_range *range = memory_range_of(plan, variable);
    if (!variable->is_varying)
        return;
    if (!range->is_used) {
        range->is_used = true;
        range->first = range->last = plan->position;
        range->line = t->node->at ? t->node->at->line : 0;
    }
    range->first = plan->position < range->first ? plan->position : range->first;
    range->last = plan->position > range->last ? plan->position : range->last;
    range->touches++;
}

/* What the shared stream takes is handed over when pre-illum ends, and what it works with is not
 * the shader's. */
static void touch_node(struct memory_plan *plan, struct ir_node *node) {
    struct touch t = {plan, node};
    if (plan->stream == SHADER_SHARED) {
        plan->has_shared = true;
        plan->position = plan->memory->illum_begin - 1;
        ir_each_read(node, touch, &t);
        return;
    }
    plan->position++;
    node->order = plan->position;
    ir_each_read(node, touch, &t);
    ir_each_write(node, touch, &t);
}

static void find_stream(struct ir_node *node, void *context) {
    struct memory_plan *plan = context;
    plan->is_found |= node->kind == NODE_INSTRUCTION && node->stream == plan->stream;
}

static bool has_stream(struct memory_plan *plan, struct ir_node *node) {
    plan->is_found = false;
    ir_each_node(node->test, find_stream, plan);
    ir_each_node(node->body, find_stream, plan);
    ir_each_node(node->otherwise, find_stream, plan);
    return plan->is_found;
}

static void number_list(struct memory_plan *plan, struct ir_list *list);

/* Control flow stands in every stream that holds something of it. */
static void number_control(struct memory_plan *plan, struct ir_node *node) {
    if (!has_stream(plan, node))
        return;
    const int begin = plan->position + 1;
    if (node->kind != NODE_LOOP)
        touch_node(plan, node);
    number_list(plan, node->test);
    if (node->kind == NODE_LOOP)
        touch_node(plan, node);
    number_list(plan, node->body);
    number_list(plan, node->otherwise);
    if (node->kind == NODE_LOOP)
        memory_add_loop(plan, node, begin, plan->position);
}

static void number_list(struct memory_plan *plan, struct ir_list *list) {
    for (struct ir_node *node = list ? list->first : NULL; node; node = node->next) {
        if (node->is_prepared)
            continue;
        if (node->kind != NODE_INSTRUCTION)
            number_control(plan, node);
        else if (node->stream == plan->stream)
            touch_node(plan, node);
    }
}

void memory_add_loop(struct memory_plan *plan, struct ir_node *node, int begin, int end) {
    struct memory_loop *loop = compilation_get(plan->ir->c, sizeof *loop);
    *loop = (struct memory_loop){node, begin, end, plan->loops};
    plan->loops = loop;
}

static bool is_inside(const struct ir_variable *variable, const struct ir_node *node) {
    for (const struct ir_list *list = variable->home; list->owner; list = list->owner->list)
        if (list->owner == node)
            return true;
    return false;
}

static bool is_inside_illuminance(const struct ir_variable *variable) {
    for (const struct ir_list *list = variable->home; list->owner; list = list->owner->list)
        if (list->owner->kind == NODE_ILLUMINANCE)
            return true;
    return false;
}

/* A loop needs what it touches from beginning to end. Inner loops come first in the list... the
 * order does not matter: ranges only grow, and outer loops contain inner ones. */
static void extend_over_loops(struct memory_plan *plan) {
    for (size_t i = 0; i < plan->ir->variable_count; i++) {
        const struct ir_variable *variable = plan->ir->variables[i];
        struct memory_range *range = &plan->ranges[i];
        if (!range->is_used)
            continue;
        for (const struct memory_loop *loop = plan->loops; loop; loop = loop->next) {
            const bool is_local =
                loop->node ? is_inside(variable, loop->node) : is_inside_illuminance(variable);
            if (is_local || range->last < loop->begin || range->first > loop->end)
                continue;
            range->first = range->first < loop->begin ? range->first : loop->begin;
            range->last = range->last > loop->end ? range->last : loop->end;
        }
    }
}

static void count_definition(struct ir_variable *variable, void *context) {
    variable->definition_count++;
    variable->definition = context;
}

static void count_definitions(struct ir_node *node, void *context) {
    ir_each_write(node, count_definition, node);
}

static void number_program(struct memory_plan *plan) {
    struct ir_program *ir = plan->ir;
    struct shader_memory *memory = plan->memory;
    for (size_t i = 0; i < ir->variable_count; i++)
        ir->variables[i]->definition_count = 0;
    ir_each_node(ir->top, count_definitions, NULL);
    for (int stream = 0; stream < SHADER_STREAM_COUNT; stream++) {
        plan->stream = (enum shader_stream)stream;
        const int begin = plan->position + 1;
        number_list(plan, ir->top);
        if (stream != SHADER_SHARED)
            memory->instructions = plan->position;
        if (stream != SHADER_ILLUM)
            continue;
        memory->illum_begin = begin;
        memory->illum_end = plan->position;
        if (plan->position >= begin)
            memory_add_loop(plan, NULL, begin, plan->position);
    }
    plan->position = memory->instructions;
    struct ir_variable *results[IR_RESULTS_MAX];
    const int count = ir_results(ir, results);
    plan->position++;
    for (int i = 0; i < count; i++)
        touch(results[i], &(struct touch){plan, &(struct ir_node){0}});
    extend_over_loops(plan);
}

static int compare_ranges(const void *a, const void *b) {
    const struct memory_range *x = *(struct memory_range *const *)a,
                              *y = *(struct memory_range *const *)b;
    return x->first != y->first
               ? (x->first > y->first) - (x->first < y->first)
               : (x->variable->id > y->variable->id) - (x->variable->id < y->variable->id);
}

static bool is_of_shared(const struct ir_variable *variable) {
    return variable->definition && variable->definition->kind == NODE_INSTRUCTION &&
           variable->definition->is_shared;
}

/* The variables that want a place, by first assignment. */
static void collect_ranges(struct memory_plan *plan) {
    struct ir_program *ir = plan->ir;
    plan->order = compilation_get(ir->c, (ir->variable_count + 1) * sizeof *plan->order);
    for (size_t i = 0; i < ir->variable_count; i++) {
        struct memory_range *range = &plan->ranges[i];
        range->variable = ir->variables[i];
        range->bytes = memory_variable_bytes(ir->variables[i]);
        if (range->is_used && !is_alias(ir->variables[i]) && !is_of_shared(ir->variables[i]))
            plan->order[plan->count++] = range;
    }
    qsort(plan->order, plan->count, sizeof *plan->order, compare_ranges);
}

/* First fit. Places whose variable dies where another is born are free for it. */
void memory_allocate(struct memory_plan *plan) {
    const struct memory_range **active =
        compilation_get(plan->ir->c, (plan->count + 1) * sizeof *active);
    size_t active_count = 0; /* by address */
    plan->memory->allocated = 0;
    for (size_t i = 0; i < plan->count; i++) {
        struct memory_range *range = plan->order[i];
        if (range->is_spilled)
            continue;
        size_t kept = 0;
        for (size_t k = 0; k < active_count; k++)
            if (active[k]->last > range->first)
                active[kept++] = active[k];
        active_count = kept;
        int address = 0;
        size_t at = 0;
        while (at < active_count && active[at]->address < address + range->bytes) {
            address = active[at]->address + active[at]->bytes;
            at++;
        }
        range->address = address;
        memmove(active + at + 1, active + at, (active_count - at) * sizeof *active);
        active[at] = range;
        active_count++;
        if (address + range->bytes > plan->memory->allocated)
            plan->memory->allocated = address + range->bytes;
    }
}

static int retained_bytes(const struct memory_plan *plan) {
    int highest = 0;
    for (size_t i = 0; i < plan->count; i++) {
        const struct memory_range *range = plan->order[i];
        if (!range->is_spilled && range->first < plan->memory->illum_begin &&
            range->last >= plan->memory->illum_begin && range->address + range->bytes > highest)
            highest = range->address + range->bytes;
    }
    return highest;
}

struct used_sources {
    bool position, incident, direction, color;
};

static void find_sources(struct ir_node *node, void *context) {
    struct used_sources *used = context;
    if (node->kind != NODE_INSTRUCTION)
        return;
    used->position |= node->operation == IR_POSITION;
    used->incident |= node->operation == IR_INCIDENT;
    used->direction |= node->operation == IR_LIGHT_DIRECTION;
    used->color |= node->operation == IR_LIGHT_COLOR;
}

static bool is_parameter(const struct shader_program *program, const char *name) {
    for (int i = 0; i < program->parameter_count; i++)
        if (!strcmp(program->parameters[i].name, name))
            return true;
    return false;
}

/* What table 4 of PF counts before allocation: everything with a name in the source. */
static void measure_declarations(struct memory_plan *plan, const struct used_sources *used) {
    const struct ir_program *ir = plan->ir;
    const struct shader_program *program = ir->c->program;
    struct shader_memory *memory = plan->memory;
    bool *varies = compilation_get(ir->c, ir->variable_count + 1);
    for (size_t i = 0; i < ir->variable_count; i++) {
        const struct ir_variable *variable = ir->variables[i];
        varies[variable->declared ? variable->declared->id : variable->id] |= variable->is_varying;
    }
    for (size_t i = 0; i < ir->variable_count; i++) {
        const struct ir_variable *variable = ir->variables[i];
        if (variable->declared || !variable->name || variable->type == IR_STRING ||
            variable->is_shared || is_parameter(program, variable->name))
            continue;
        memory->total += memory_variable_bytes(variable);
        memory->varying += varies[i] ? memory_variable_bytes(variable) : 0;
    }
    for (int i = 0; i < program->parameter_count; i++) {
        const struct shader_parameter *parameter = &program->parameters[i];
        if ((parameter->is_global && !parameter->is_live) || parameter->type == SHADER_STRING)
            continue;
        memory->total += parameter->bytes;
        memory->varying += parameter->is_varying ? parameter->bytes : 0;
    }
    enum { TRIPLE_BYTES = 12 };
    const int predefined =
        TRIPLE_BYTES * (used->position + used->incident + used->direction + used->color);
    memory->total += predefined;
    memory->varying += predefined;
}

/* Bytes taken by what is there before the shader begins. */
static void measure_surroundings(struct memory_plan *plan) {
    const struct ir_program *ir = plan->ir;
    struct shader_memory *memory = plan->memory;
    struct used_sources used = {0};
    ir_each_node(ir->top, find_sources, &used);
    used.position |= ir->uses_illuminance; /* lights ask for it */
    const bool is_light = ir->kind == SHADER_KIND_LIGHT;
    const bool has_lights = ir->uses_illuminance || is_light;
    measure_declarations(plan, &used);
    memory->position = used.position || used.incident ? POSITION_BYTES : 0;
    memory->communication = (has_lights ? LIGHT_BYTES : 0) +
                            (ir->uses_ambient ? AMBIENT_BYTES : 0) +
                            (plan->has_shared ? SHARED_BYTES : 0);
    memory->parameters = is_light ? 0 : SHADER_ID_BYTES + ir->c->program->material_bytes;
    const struct shader_compile_options *options = ir->c->options;
    memory->available =
        options && options->pixel_memory_bytes ? options->pixel_memory_bytes : DEFAULT_BYTES;
}

static void report(struct memory_plan *plan) {
    struct shader_program *program = plan->ir->c->program;
    struct shader_lifetime *lifetimes =
        arena_get(&program->arena, (plan->count + 1) * sizeof *lifetimes);
    if (!lifetimes)
        compile_limit(plan->ir->c, NULL, "the shader needs more memory than the compiler may use");
    for (size_t i = 0; i < plan->count; i++) {
        const struct memory_range *range = plan->order[i];
        const char *name = range->variable->name ? range->variable->name : "";
        lifetimes[i] = (struct shader_lifetime){
            .name = arena_copy_string(&program->arena, name, strlen(name)),
            .line = range->line,
            .bytes = range->bytes,
            .first = range->first,
            .last = range->last,
            .address = range->is_spilled ? -1 : range->address,
        };
    }
    plan->memory->lifetimes = lifetimes;
    plan->memory->lifetime_count = (int)plan->count;
}

void pass_memory(struct ir_program *ir) {
    struct memory_plan plan = {.ir = ir, .memory = &ir->c->program->memory};
    *plan.memory = (struct shader_memory){0};
    plan.ranges = compilation_get(ir->c, (ir->variable_count + 1) * sizeof *plan.ranges);
    number_program(&plan);
    collect_ranges(&plan);
    measure_surroundings(&plan);
    struct shader_memory *memory = plan.memory;
    const int room =
        memory->available - memory->parameters - memory->position - memory->communication;
    memory_allocate(&plan);
    memory_spill(&plan, room);
    memory->retained = memory->illum_end >= memory->illum_begin ? retained_bytes(&plan) : 0;
    memory->free = room - memory->allocated;
    report(&plan);
}
