/* SPDX-License-Identifier: Apache-2.0 */
#include "shaders/compiler/call_sites.h"

#include "base/hash.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { LISTED_MAX = 12 };

const char *shader_call_function(const struct shader_call_site *site) {
    static const char *const names[] = {
#define OPERATION_NAME(name, key, what) key,
        SIMD_OPERATIONS(OPERATION_NAME)
#undef OPERATION_NAME
    };
    return names[site->function];
}

/* The function of an operation, -1 when it has no fast version. */
static int function_of(enum ir_operation operation) {
    const int cost = ir_operations[operation].cost;
    return cost != IR_FREE && simd_operation_fast(cost) != cost ? cost : -1;
}

/* The list that chooses among calls of the shader being lowered. */
static const struct shader_fast_calls *wanted_calls(const struct lowering *l) {
    const struct shader_compile_options *options = l->c->options;
    if (!options)
        return NULL;
    if (l->kind == SHADER_KIND_DISPLACEMENT && options->displacement)
        return &options->displacement->fast_calls;
    if (l->kind == SHADER_KIND_VOLUME && options->atmosphere)
        return &options->atmosphere->fast_calls;
    return &options->fast_calls;
}

static bool is_at(const struct shader_fast_call *call, const struct shader_call_site *site) {
    return call->line == site->line && call->column == site->column &&
           (call->file ? !strcmp(call->file, site->file) : !site->is_included);
}

static bool is_chosen(const struct lowering *l, const struct shader_call_site *site) {
    const struct shader_fast_calls *wanted = wanted_calls(l);
    bool result = wanted && (wanted->all || l->c->options->fast_math);
    for (int i = 0; wanted && i < wanted->count; i++)
        result |= is_at(&wanted->list[i], site);
    return result;
}

static bool same_site(const struct shader_call_site *a, const struct shader_call_site *b) {
    return a->line == b->line && a->column == b->column && a->function == b->function &&
           a->kind == b->kind && !strcmp(a->file, b->file);
}

static unsigned bucket_of(const struct shader_call_site *site) {
    const int key[] = {site->line, site->column, site->function};
    return (unsigned)(hash_bytes(key, sizeof key, 1) % CALL_SITE_BUCKETS);
}

struct call_site *call_site_of(struct lowering *l, const struct ir_node *node) {
    const int function = function_of(node->operation);
    if (function < 0)
        return NULL;
    const struct source_location *at = node->at;
    struct shader_call_site about = {.kind = (int)l->kind,
                                     .file = at->file,
                                     .is_included = strcmp(at->file, l->file) != 0,
                                     .line = at->line,
                                     .column = at->column,
                                     .function = function};
    struct call_site **bucket = &l->ir->call_site_buckets[bucket_of(&about)];
    for (struct call_site *site = *bucket; site; site = site->below)
        if (same_site(&site->about, &about))
            return site;
    struct call_site *site = compilation_get(l->c, sizeof *site);
    about.is_fast = is_chosen(l, &about);
    *site = (struct call_site){.about = about, .below = *bucket, .next = l->ir->call_sites};
    *bucket = l->ir->call_sites = site;
    l->ir->call_site_count++;
    return site;
}

/* Shaders in the order they run in, places in that of the text. */
static int compare_sites(const void *a, const void *b) {
    const struct shader_call_site *x = &(*(struct call_site *const *)a)->about,
                                  *y = &(*(struct call_site *const *)b)->about;
    const int order[] = {x->kind - y->kind,        x->is_included - y->is_included,
                         strcmp(x->file, y->file), x->line - y->line,
                         x->column - y->column,    x->function - y->function};
    for (size_t i = 0; i < sizeof order / sizeof *order; i++)
        if (order[i])
            return order[i];
    return 0;
}

static void sort_sites(struct ir_program *ir) {
    struct call_site **list =
        compilation_get(ir->c, ((size_t)ir->call_site_count + 1) * sizeof *list);
    int count = 0;
    for (struct call_site *site = ir->call_sites; site; site = site->next)
        list[count++] = site;
    qsort(list, (size_t)count, sizeof *list, compare_sites);
    for (int i = 0; i < count; i++) {
        list[i]->number = i;
        list[i]->next = list[i + 1];
    }
    ir->call_sites = list[0];
}

/* "sin at 30:24, pow at 45:18" */
static void list_sites(const struct lowering *l, char *text, size_t size) {
    size_t used = 0;
    int count = 0;
    text[0] = 0;
    for (const struct call_site *site = l->ir->call_sites; site && used < size; site = site->next) {
        const struct shader_call_site *about = &site->about;
        if (about->kind != (int)l->kind)
            continue;
        if (count++ == LISTED_MAX) {
            snprintf(text + used, size - used, " ...");
            return;
        }
        used += (size_t)snprintf(text + used, size - used, "%s%s at %.80s%s%d:%d", used ? ", " : "",
                                 shader_call_function(about), about->is_included ? about->file : "",
                                 about->is_included ? ":" : "", about->line, about->column);
    }
    if (!count)
        snprintf(text, size, "no such call");
}

static void check_wanted(struct lowering *l, const struct checked_unit *unit) {
    l->kind = unit->unit->kind;
    const struct shader_fast_calls *wanted = wanted_calls(l);
    for (int i = 0; wanted && i < wanted->count; i++) {
        const struct shader_fast_call *call = &wanted->list[i];
        bool is_there = false;
        for (const struct call_site *site = l->ir->call_sites; site && !is_there; site = site->next)
            is_there = site->about.kind == (int)l->kind && is_at(call, &site->about);
        if (is_there)
            continue;
        char known[300];
        list_sites(l, known, sizeof known);
        compile_error(l->c, &unit->unit->shader->at,
                      "no function with a fast version is called at %.80s%s%d:%d; %.64s has: %s",
                      call->file ? call->file : "", call->file ? ":" : "", call->line, call->column,
                      unit->unit->shader->name, known);
    }
}

void call_sites_finish(struct lowering *l) {
    sort_sites(l->ir);
    for (int i = 0; i < l->unit_count; i++)
        check_wanted(l, &l->units[i]);
}

static void count_call(struct ir_node *node, void *context) {
    if (node->kind != NODE_INSTRUCTION || !node->call_site)
        return;
    node->call_site->about.instructions++;
    node->call_site->about.issued +=
        !node->is_prepared && ir_instruction_is_varying(node) && ir_instruction_reads_varying(node);
}

void call_sites_report(const struct ir_program *ir) {
    struct shader_program *program = ir->c->program;
    ir_each_node(ir->top, count_call, NULL);
    struct shader_call_site *list =
        arena_get(&program->arena, ((size_t)ir->call_site_count + 1) * sizeof *list);
    if (!list)
        compile_limit(ir->c, NULL, "the shader needs more memory than the compiler may use");
    for (const struct call_site *site = ir->call_sites; site; site = site->next) {
        struct shader_call_site *copy = &list[program->call_site_count++];
        *copy = site->about;
        copy->file = arena_copy_string(&program->arena, copy->file, strlen(copy->file));
        if (!copy->file)
            compile_limit(ir->c, NULL, "the shader needs more memory than the compiler may use");
    }
    program->call_sites = list;
}
