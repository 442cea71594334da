/* SPDX-License-Identifier: Apache-2.0 */
#include "random_internal.h"

#include <stdio.h>
#include <string.h>

typedef struct random_generator generator;

/* ---- types ---- */

enum ast_type random_fixed(generator *g) {
    return g->format_count ? ast_type_fixed(g->formats[random_below(g, g->format_count)])
                           : TYPE_FLOAT;
}

/* Sizes and exponents as shaders have them, and any. */
void random_choose_formats(generator *g) {
    g->format_count = 1 + random_below(g, RANDOM_FORMATS);
    for (int i = 0; i < g->format_count; i++) {
        struct fixed_format *f = &g->formats[i];
        f->size = (int16_t)(1 + random_below(g, 64));
        f->exponent = (int16_t)(random_once_in(g, 8) ? random_below(g, 201) - 70
                                                     : f->size - random_below(g, f->size + 8));
        f->is_unsigned = random_once_in(g, 3);
        if (random_once_in(g, 3))
            *f = (struct fixed_format){16, (int16_t)random_below(g, 17), f->is_unsigned};
    }
}

enum ast_type random_any_type(generator *g) {
    if (g->format_count && random_once_in(g, 2))
        return random_fixed(g);
    int which = random_below(g, 13);
    return which < 6 ? TYPE_FLOAT : which < 12 ? random_triple(g) : TYPE_MATRIX;
}

/* ---- variables ---- */

struct random_variable *random_add_variable(generator *g, const char *name, enum ast_type type) {
    struct random_variable *v = &g->variables[g->variable_count++];
    *v = (struct random_variable){.type = type};
    snprintf(v->name, sizeof v->name, "%s", name);
    return v;
}

bool random_has_room(const generator *g) {
    return g->variable_count < RANDOM_VARIABLES - 32; /* those of a function, too */
}

/* A new name, or that of a variable outside of this scope, which it then hides. */
static void choose_name(generator *g, char name[8]) {
    snprintf(name, 8, "v%d", g->next_number++);
    if (g->scope_start <= g->first_visible || !random_once_in(g, 8))
        return;
    int which = g->first_visible + random_below(g, g->scope_start - g->first_visible);
    const char *outer = g->variables[which].name;
    for (int i = g->scope_start; i < g->variable_count; i++)
        if (!strcmp(g->variables[i].name, outer))
            return;
    if (outer[0] == 'v')
        snprintf(name, 8, "%s", outer);
}

/* An array that another of this type and length can be copied from or into; NULL: none was met. */
static const struct random_variable *same_array(generator *g, enum ast_type type, int length,
                                                bool is_written, bool is_uniform) {
    const struct random_variable *v = random_array(g, type, is_written, is_uniform);
    return v && v->length == length && !v->is_open ? v : NULL;
}

/* A whole array of a type and length, or a triple; false when nothing was written. */
bool random_whole_array(generator *g, enum ast_type type, int length, bool is_uniform) {
    const struct random_variable *v = same_array(g, type, length, false, is_uniform);
    bool is_numeric = type == TYPE_FLOAT || ast_type_is_fixed(type);
    if (!v && is_numeric)
        v = same_array(g, type == TYPE_FLOAT ? random_fixed(g) : TYPE_FLOAT, length, false,
                       is_uniform);
    if (v)
        random_put(g, " = %s", v->name);
    if (v || length != 3 || !is_numeric)
        return v != NULL;
    random_put(g, " = ");
    random_expression(g, random_triple(g), 2, is_uniform);
    return true;
}

static void declare_array(generator *g, enum ast_type type, bool is_uniform) {
    char name[8];
    int length = 1 + random_below(g, type == TYPE_MATRIX ? 2 : 6),
        given = is_uniform ? length : random_below(g, length + 1);
    choose_name(g, name);
    random_start_line(g);
    random_put(g, "%s%s %s[%d]", is_uniform ? "uniform " : "", random_type_word(type), name,
               length);
    if (random_once_in(g, 2) && random_whole_array(g, type, length, is_uniform))
        given = 0;
    for (int i = 0; i < given; i++) {
        random_put(g, i ? ", " : " = {");
        random_expression(g, type, 1, is_uniform);
    }
    random_put(g, given ? "};\n" : ";\n");
    struct random_variable *v = random_add_variable(g, name, type);
    v->length = length;
    v->is_uniform = is_uniform;
}

void random_declare(generator *g) {
    char name[8];
    enum ast_type type = random_any_type(g);
    bool is_uniform = !g->has_jumped && random_once_in(g, 5);
    bool is_varying = !is_uniform && random_once_in(g, 8);
    if (!random_has_room(g))
        return;
    if (random_once_in(g, type == TYPE_MATRIX ? 10 : 5)) {
        declare_array(g, type, is_uniform);
        return;
    }
    choose_name(g, name);
    random_start_line(g);
    random_put(g, "%s%s %s",
               is_uniform   ? "uniform "
               : is_varying ? "varying "
                            : "",
               random_type_word(type), name);
    if (is_uniform || !random_once_in(g, 8)) {
        random_put(g, " = ");
        random_expression(g, type, 2 + random_below(g, 2), is_uniform);
    }
    random_put(g, ";\n");
    random_add_variable(g, name, type)->is_uniform = is_uniform;
}

void random_declare_string(generator *g) {
    char name[8];
    if (g->has_jumped || !random_has_room(g))
        return;
    choose_name(g, name);
    random_start_line(g);
    random_put(g, "string %s = \"%s\";\n", name, random_once_in(g, 2) ? "world" : "object");
    struct random_variable *v = random_add_variable(g, name, TYPE_STRING);
    v->is_uniform = v->is_readonly = true;
}
