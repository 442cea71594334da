/* SPDX-License-Identifier: Apache-2.0 */
#include "random_internal.h"

#include "base/hash.h"
#include "base/status.h"
#include "shaders/simd/shader_module.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

typedef struct random_generator generator;

void random_put(generator *g, const char *format, ...) {
    va_list arguments;
    char text[512];
    va_start(arguments, format);
    size_t length = (size_t)vsnprintf(text, sizeof text, format, arguments);
    va_end(arguments);
    g->program->text = memory_grow(g->program->text, &g->capacity, g->length + length + 1, 1);
    memcpy(g->program->text + g->length, text, length + 1);
    g->length += length;
}

const char *random_type_word(enum ast_type type) {
    return type == TYPE_VOID ? "void" : ast_type_name(type);
}

enum ast_type random_triple(generator *g) {
    return TYPE_COLOR + (enum ast_type)random_below(g, 4);
}

void random_start_line(generator *g) {
    random_put(g, "%*s", 4 * g->indent, "");
}

/* ---- statements ---- */

static void statements(generator *g, int count);

static void braced(generator *g, int count) {
    int variables = g->variable_count, functions = g->function_count, scope = g->scope_start;
    g->scope_start = g->variable_count;
    g->indent++;
    statements(g, count);
    g->indent--;
    g->variable_count = variables;
    g->function_count = functions;
    g->scope_start = scope;
    random_start_line(g);
    random_put(g, "}\n");
}

/* One array into another; false when there is none. */
static bool copy_array(generator *g, const struct random_variable *to) {
    if (to->is_open)
        return false;
    size_t length = g->length;
    random_start_line(g);
    random_put(g, "%s", to->name);
    if (random_whole_array(g, to->type, to->length, false)) {
        random_put(g, ";\n");
        return true;
    }
    g->length = length;
    return false;
}

static void assign(generator *g) {
    static const char *const operators[] = {"=", "=", "=", "+=", "-=", "*=", "/="};
    enum ast_type type = random_any_type(g);
    const struct random_variable *v = random_target(g, type), *array;
    const char *word = operators[random_below(g, 7)];
    if (type == TYPE_MATRIX && (word[0] == '+' || word[0] == '-'))
        word = "/=";
    array = random_once_in(g, 3) ? random_array(g, type, true, false) : NULL;
    if (!v && !array)
        return;
    if (array && random_once_in(g, 3) && copy_array(g, array))
        return;
    random_start_line(g);
    if (array) {
        random_put(g, "%s[", array->name);
        random_index(g, false);
        random_put(g, "] %s ", word);
    } else {
        random_put(g, "%s %s ", v->name, word);
    }
    random_expression(g, type, 3, false);
    random_put(g, ";\n");
}

static void set_component(generator *g) {
    static const char *const names[] = {"setxcomp", "setycomp", "setzcomp", "setcomp"};
    int which = random_below(g, 4);
    enum ast_type type = random_once_in(g, 4) ? TYPE_MATRIX : random_triple(g);
    const struct random_variable *v = random_target(g, type);
    if (!v)
        return;
    random_start_line(g);
    random_put(g, "%s(%s", type == TYPE_MATRIX ? "setcomp" : names[which], v->name);
    for (int i = type == TYPE_MATRIX ? 0 : which == 3 ? 1 : 2; i < 3; i++) {
        random_put(g, ", ");
        random_expression(g, TYPE_FLOAT, 2, false);
    }
    random_put(g, ");\n");
}

static void branch(generator *g) {
    bool has_else = random_once_in(g, 3);
    random_start_line(g);
    random_put(g, "if (");
    random_condition(g, 2, false);
    random_put(g, ") {\n");
    g->nesting++;
    braced(g, 1 + random_below(g, 3));
    if (has_else) {
        random_start_line(g);
        random_put(g, "else {\n");
        braced(g, 1 + random_below(g, 3));
    }
    g->nesting--;
}

static void loop_body(generator *g, bool is_uniform) {
    int open = g->open_loops, cost = g->cost;
    bool may_return = g->may_return;
    g->open_loops = is_uniform ? 0 : g->open_loops + 1;
    g->may_return &= !is_uniform;
    g->nesting++;
    g->loops++;
    braced(g, 1 + random_below(g, 3));
    g->loops--;
    g->nesting--;
    g->open_loops = open;
    g->may_return = may_return;
    g->cost += (g->cost - cost) / 2;
}

static void loop(generator *g) {
    bool is_uniform = !g->has_jumped && random_once_in(g, 2), is_while = random_once_in(g, 3);
    int trips = 1 + random_below(g, 3);
    char name[8];
    if (!random_has_room(g) || g->loops > 2)
        return;
    snprintf(name, sizeof name, "i%d", g->next_number++);
    random_start_line(g);
    random_put(g, "%sfloat %s = %d;\n", is_uniform ? "uniform " : "", name, is_while ? 0 : 5);
    struct random_variable *v = random_add_variable(g, name, TYPE_FLOAT);
    v->is_readonly = true;
    v->is_uniform = is_uniform;
    random_start_line(g);
    if (is_while)
        random_put(g, "while (%s < %d", name, trips);
    else
        random_put(g, "for (%s = 0; %s < %d", name, name, trips);
    if (!is_uniform && random_once_in(g, 2)) {
        random_put(g, " && ");
        random_condition(g, 1, false);
    }
    if (is_while)
        random_put(g, ") { %s += 1;\n", name);
    else
        random_put(g, "; %s += 1) {\n", name);
    loop_body(g, is_uniform);
}

static void jump(generator *g) {
    bool is_return = g->may_return && (g->open_loops == 0 || random_once_in(g, 3));
    if (!is_return && g->open_loops == 0)
        return;
    g->has_jumped = true;
    random_start_line(g);
    random_put(g, "if (");
    random_condition(g, 1, false);
    random_put(g, ") ");
    int level = is_return ? 0 : 1 + random_below(g, g->open_loops);
    if (!is_return) {
        random_put(g, random_once_in(g, 2) ? "break" : "continue");
        random_put(g, level == 1 && random_once_in(g, 2) ? ";\n" : " %d;\n", level);
        return;
    }
    random_put(g, "return");
    if (g->result != TYPE_VOID) {
        random_put(g, " ");
        random_expression(g, g->result, 2, false);
    }
    random_put(g, ";\n");
}

static void illuminance(generator *g) {
    if (g->program->is_light || g->in_illuminance || !random_has_room(g) || g->loops > 1)
        return;
    g->uses_illuminance = true;
    random_start_line(g);
    random_put(g, "illuminance (P");
    if (random_once_in(g, 2)) {
        random_put(g, ", ");
        random_expression(g, TYPE_VECTOR, 2, false);
        random_put(g, ", ");
        random_expression(g, TYPE_FLOAT, 1, false);
    }
    random_put(g, ") {\n");
    int variables = g->variable_count;
    random_add_variable(g, "L", TYPE_VECTOR)->is_readonly = true;
    random_add_variable(g, "Cl", TYPE_COLOR)->is_readonly = true;
    g->in_illuminance = true;
    loop_body(g, false);
    g->in_illuminance = false;
    g->variable_count = variables;
}

static void illuminate(generator *g) {
    if (!g->program->is_light || g->in_illuminate || g->in_function)
        return;
    bool is_solar = random_once_in(g, 3);
    random_start_line(g);
    random_put(g, is_solar ? "solar (" : "illuminate (");
    random_expression(g, is_solar ? TYPE_VECTOR : TYPE_POINT, 1, false);
    if (is_solar) {
        random_put(g, ", 0) {\n");
    } else if (random_once_in(g, 2)) {
        random_put(g, ", ");
        random_expression(g, TYPE_VECTOR, 1, false);
        random_put(g, ", %.3g) {\n", 3 * rng_unit(&g->rng));
    } else {
        random_put(g, ") {\n");
    }
    g->in_illuminate = true;
    int open = g->open_loops;
    g->open_loops = 0;
    g->nesting++;
    braced(g, 2);
    g->nesting--;
    g->open_loops = open;
    g->in_illuminate = false;
}

static void assign_uniform(generator *g) {
    const struct random_variable *v = NULL;
    int fitting = 0;
    for (int i = g->scope_start; i < g->variable_count; i++)
        if (g->variables[i].is_uniform && !g->variables[i].is_readonly && !g->variables[i].length &&
            random_once_in(g, ++fitting))
            v = &g->variables[i];
    if (!v || g->has_jumped)
        return;
    random_start_line(g);
    random_put(g, "%s = ", v->name);
    random_expression(g, v->type, 2, true);
    random_put(g, ";\n");
}

static void define_function(generator *g);

static void statement(generator *g) {
    switch (random_below(g, 24)) {
    case 0:
    case 1:
    case 2:
    case 3:
        random_declare(g);
        break;
    case 4:
        random_declare_string(g);
        break;
    case 5:
        set_component(g);
        break;
    case 6:
        assign_uniform(g);
        break;
    case 7:
    case 8:
        if (g->nesting < 3)
            branch(g);
        break;
    case 9:
    case 10:
        if (g->nesting < 3)
            loop(g);
        break;
    case 11:
        if (g->nesting < 3)
            illuminance(g);
        break;
    case 12:
    case 13:
        if (g->nesting)
            jump(g);
        break;
    case 14:
        if (!g->in_illuminate && g->function_count < RANDOM_FUNCTIONS && random_has_room(g) &&
            g->nesting < 2)
            define_function(g);
        break;
    case 15:
        random_start_line(g);
        random_put(g, random_call(g, TYPE_VOID, 2) ? ";\n" : "\n");
        break;
    case 16:
        if (g->nesting < 2)
            illuminate(g);
        break;
    case 17:
        if (g->nesting < 3) {
            random_start_line(g);
            random_put(g, "{\n");
            braced(g, 2);
        }
        break;
    default:
        assign(g);
    }
}

static void statements(generator *g, int count) {
    for (int i = 0; i < count && g->cost < g->cost_max; i++)
        statement(g);
}

/* ---- functions ---- */

static void define_formals(generator *g, struct random_function *f) {
    for (int i = 0; i < f->formal_count; i++) {
        struct random_variable *v = &f->formals[i];
        v->type = random_any_type(g);
        v->length = v->type != TYPE_MATRIX && random_once_in(g, 8) ? 4 : 0;
        f->is_output[i] = random_once_in(g, 3);
        v->is_uniform = !f->is_output[i] && !v->length && random_once_in(g, 8);
        snprintf(v->name, sizeof v->name, "v%d", g->next_number++);
        random_put(g, "%s%s%s%s %s%s", i ? "; " : "", f->is_output[i] ? "output " : "",
                   v->is_uniform ? "uniform " : "", random_type_word(v->type), v->name,
                   v->length ? "[]" : "");
        struct random_variable *added = random_add_variable(g, v->name, v->type);
        added->length = v->length;
        added->is_open = v->length != 0;
        added->is_uniform = v->is_uniform;
        added->is_readonly = v->is_uniform || (v->length && !f->is_output[i]);
    }
}

/* The predefined variables of this kind of shader, into the list of what is visible. */
static void add_globals(generator *g) {
    random_add_variable(g, "P", TYPE_POINT)->is_readonly =
        !g->program->is_light; /* lights are at P */
    random_add_variable(g, "N", TYPE_NORMAL);
    random_add_variable(g, "PI", TYPE_FLOAT)->is_readonly = true;
    if (g->program->is_light) {
        random_add_variable(g, "Ps", TYPE_POINT)->is_readonly = true;
        return;
    }
    random_add_variable(g, "s", TYPE_FLOAT);
    random_add_variable(g, "t", TYPE_FLOAT)->is_readonly = true;
    random_add_variable(g, "u", TYPE_FLOAT)->is_readonly = true;
    random_add_variable(g, "I", TYPE_VECTOR)->is_readonly = true;
    random_add_variable(g, "Ng", TYPE_NORMAL)->is_readonly = true;
    random_add_variable(g, "Cs", TYPE_COLOR)->is_readonly = true;
    random_add_variable(g, "Ci", TYPE_COLOR);
}

/* A new name; or that of another function of the file, which takes another number of arguments. */
static void name_function(generator *g, struct random_function *f) {
    snprintf(f->name, sizeof f->name, "f%d", g->next_number++);
    if (f->is_nested || !g->function_count || !random_once_in(g, 3))
        return;
    const char *name = g->functions[random_below(g, g->function_count)].name;
    for (int i = 0; i < g->function_count; i++)
        if (!strcmp(g->functions[i].name, name) && g->functions[i].formal_count == f->formal_count)
            return;
    snprintf(f->name, sizeof f->name, "%s", name);
}

static void define_function(generator *g) {
    generator outer = *g;
    struct random_function f = {.type = random_once_in(g, 4) ? TYPE_VOID : random_any_type(g),
                                .formal_count = random_below(g, RANDOM_FORMALS),
                                .is_nested = g->indent != 0};
    if (!(f.is_nested && g->first_visible == 0 && g->variable_count)) {
        g->first_visible = g->variable_count;
        add_globals(g);
    }
    g->scope_start = g->variable_count;
    name_function(g, &f);
    random_start_line(g);
    random_put(g, "%s %s(", random_type_word(f.type), f.name);
    define_formals(g, &f);
    random_put(g, ") {\n");
    g->open_loops = g->loops = g->cost = 0; /* calls count, definitions do not */
    g->cost_max = 6 + random_below(g, 20);
    g->may_return = g->in_function = true;
    g->has_jumped = g->uses_illuminance = false;
    g->result = f.type;
    g->nesting++;
    g->indent++;
    statements(g, 1 + random_below(g, 4));
    random_start_line(g);
    if (f.type != TYPE_VOID) {
        random_put(g, "return ");
        random_expression(g, f.type, 3, false);
        random_put(g, ";");
    }
    random_put(g, "\n%*s}\n", 4 * outer.indent, "");
    f.has_illuminance = g->uses_illuminance;
    f.cost = g->cost + 2;
    outer.rng = g->rng;
    outer.length = g->length;
    outer.capacity = g->capacity;
    outer.next_number = g->next_number;
    *g = outer;
    g->functions[g->function_count++] = f;
}

/* ---- shaders ---- */

static void define_parameter(generator *g, int number) {
    struct random_program *program = g->program;
    char name[8];
    bool is_string = random_once_in(g, 8);
    enum ast_type type = is_string ? TYPE_STRING
                         : random_once_in(g, 2)
                             ? random_once_in(g, 3) ? TYPE_FLOAT : random_fixed(g)
                             : random_triple(g);
    int length = !is_string && random_once_in(g, 6) ? 2 + random_below(g, 4) : 0;
    bool is_uniform = random_once_in(g, 3), is_varying = !is_uniform && random_once_in(g, 4);
    snprintf(name, sizeof name, "%c%d", is_string ? 'w' : 'p', number);
    random_put(g, "%s%s%s %s", number ? "; " : "",
               is_string    ? ""
               : is_uniform ? "uniform "
               : is_varying ? "varying "
                            : "",
               random_type_word(type), name);
    if (length) {
        random_put(g, "[%d] = {", length);
        for (int i = 0; i < length; i++) {
            random_put(g, i ? ", " : "");
            random_expression(g, type, 1, true);
        }
        random_put(g, "}");
    } else {
        random_put(g, is_string ? " = \"world\"" : " = ");
        if (!is_string)
            random_expression(g, type, 2, true);
    }
    struct random_variable *v = random_add_variable(g, name, type);
    v->length = length;
    v->is_uniform = is_uniform || is_string;
    v->is_readonly = true;
    if (!program->is_light && !v->is_uniform && random_once_in(g, 2)) {
        char *kept = program->names[program->material_count];
        snprintf(kept, sizeof program->names[0], "%s", name);
        program->material[program->material_count++] = kept;
    }
}

/* A fixed-point value as a number from 0 to 1: its upper or its lower bits. */
static void read_fixed(generator *g, const char *name, struct fixed_format f) {
    const int bits = f.size < 12 ? f.size : 12,
              exponent = random_once_in(g, 2) ? f.exponent : f.exponent - f.size + bits;
    random_put(g, "color (unsigned fixed<%d,%d> %s * %.9g);\n", bits, exponent, name,
               fmin(ldexp(1, exponent - bits), 0x1p127)); /* the largest that a float can be */
}

/* Calls some of the functions of the file, whether or not there was room for it before. */
static void call_functions(generator *g) {
    const char *result = g->program->is_light ? "Cl" : "Ci";
    for (int i = 0; i < g->function_count; i++) {
        const struct random_function *f = &g->functions[i];
        const size_t before = g->length;
        if (!random_once_in(g, 3))
            continue;
        if (f->type == TYPE_VOID)
            random_put(g, "    ");
        else
            random_put(g, "    %s = 0.7 * %s + clamp(color%s", result, result,
                       f->type == TYPE_MATRIX ? " comp(" : " (");
        if (!random_call_of(g, f, 2))
            g->length = before;
        else if (f->type == TYPE_VOID)
            random_put(g, ";\n");
        else
            random_put(g, f->type == TYPE_MATRIX ? ", 1, 3), -9, 9);\n" : "), -9, 9);\n");
    }
}

/* Everything the shader came to takes part in its result; what is not finite only sometimes. */
static void finish_shader(generator *g) {
    const char *result = g->program->is_light ? "Cl" : "Ci";
    for (int i = 0; i < g->variable_count; i++) {
        const struct random_variable *v = &g->variables[i];
        if (v->is_readonly || v->type == TYPE_STRING || !strcmp(v->name, result))
            continue;
        char name[32], read[96];
        snprintf(name, sizeof name, "%s", v->name);
        if (v->length)
            snprintf(name, sizeof name, "%s[%d]", v->name, random_below(g, v->length));
        random_put(g, "    %s = 0.7 * %s + ", result, result);
        if (ast_type_is_fixed(v->type) && !random_once_in(g, 3)) {
            read_fixed(g, name, ast_type_format(v->type));
            continue;
        }
        if (v->type == TYPE_MATRIX)
            snprintf(read, sizeof read, "(%s, 1, 2) + comp(%s, 3, 0)", name, name);
        else
            snprintf(read, sizeof read, "(%s)", name);
        random_put(g, random_once_in(g, 5) ? "color %s%s;\n" : "clamp(color %s%s, -9, 9);\n",
                   v->type == TYPE_MATRIX ? "comp" : "", read);
    }
}

void random_program_make(struct random_program *program, uint64_t seed, bool is_light) {
    generator *g = memory_get(1, sizeof *g);
    *program = (struct random_program){.seed = seed, .is_light = is_light};
    g->rng.state = seed * 2 + is_light;
    g->program = program;
    g->result = TYPE_VOID;
    g->cost_max = 12 + random_below(g, 36);
    program->fast_math = random_once_in(g, 4);
    if (seed % 2) /* any choice of passes gives the same values */
        program->passes_left_out = (uint32_t)(seed * 2654435761u >> 7);
    if (random_once_in(g, 2))
        random_choose_formats(g);
    random_put(g, "/* program %llu */\n", (unsigned long long)seed);
    for (int i = random_below(g, is_light ? 2 : 4); i > 0; i--)
        define_function(g);
    random_put(g, "%s x(", is_light ? "light" : "surface");
    for (int i = 0, count = random_below(g, is_light ? 4 : 7); i < count; i++)
        define_parameter(g, i);
    random_put(g, ";) {\n");
    add_globals(g);
    if (is_light) {
        random_add_variable(g, "L", TYPE_VECTOR);
        random_add_variable(g, "Cl", TYPE_COLOR);
    }
    g->scope_start = g->variable_count;
    g->indent = 1;
    g->may_return = true;
    g->cost = 0;
    statements(g, is_light ? 4 + random_below(g, 4) : 6 + random_below(g, 12));
    if (is_light && random_once_in(g, 2))
        illuminate(g);
    call_functions(g);
    finish_shader(g);
    random_put(g, "}\n");
    free(g);
}

void random_program_finish(struct random_program *program) {
    free(program->text);
    program->text = NULL;
}

bool random_program_input(uint64_t seed, const char *name, bool is_material, int component,
                          int sample, float *value) {
    struct rng rng = {hash_string(name, seed)};
    bool is_given = is_material || rng_next(&rng) % 2;
    if (name[0] == 'w') {
        int32_t space = SHADER_SPACE_SHADER + (int32_t)rng_below(&rng, 3);
        memcpy(value, &space, sizeof space);
        return is_given;
    }
    rng.state += (uint64_t)component * 0x1234567u + (is_material ? (uint64_t)sample << 32 : 0);
    rng_next(&rng);
    *value = (float)(5 * rng_unit(&rng) - 2);
    if (rng_next(&rng) % 4 == 0)
        *value = (float)(int)*value;
    return is_given;
}
