/* SPDX-License-Identifier: Apache-2.0 */
#include "random_internal.h"

#include <math.h>
#include <string.h>

typedef struct random_generator generator;

static const char *pick(generator *g, const char *const *words, int count) {
    return words[random_below(g, count)];
}
#define PICK(g, ...)                                                                               \
    pick(g, (const char *const[]){__VA_ARGS__},                                                    \
         (int)(sizeof((const char *const[]){__VA_ARGS__}) / sizeof(const char *)))

static void literal(generator *g) {
    if (random_once_in(g, 3))
        random_put(g, "%.3g", 0.01 + 4 * rng_unit(&g->rng));
    else
        random_put(g, "%s", PICK(g, "1", "2", "0.5", "3", "0.25", "1.5", "7", "0.1", "10"));
}

/* A variable that fits; `type` TYPE_TRIPLE: any triple. An array of at least this length, or with 0
 * none. */
static const struct random_variable *find(generator *g, enum ast_type type, bool is_uniform,
                                          bool is_written, int array_length) {
    const struct random_variable *found = NULL;
    int fitting = 0;
    for (int i = g->first_visible; i < g->variable_count; i++) {
        const struct random_variable *v = &g->variables[i];
        bool is_hidden = false;
        for (int k = i + 1; k < g->variable_count; k++)
            is_hidden |= !strcmp(v->name, g->variables[k].name);
        bool fits = v->type == type || (type == TYPE_TRIPLE && ast_type_is_triple(v->type)) ||
                    (type == TYPE_ERROR && array_length);
        bool has_length = array_length ? v->length >= array_length : v->length == 0;
        if (!is_hidden && fits && has_length && (!is_uniform || v->is_uniform) &&
            (!is_written || (!v->is_readonly && !v->is_uniform)) && random_once_in(g, ++fitting))
            found = v;
    }
    return found;
}

const struct random_variable *random_target(generator *g, enum ast_type type) {
    return g->no_effects ? NULL : find(g, type, false, true, 0);
}

const struct random_variable *random_array(generator *g, enum ast_type type, bool is_written,
                                           bool is_uniform) {
    return find(g, type, is_uniform, is_written, 1);
}

void random_index(generator *g, bool is_uniform) {
    bool outer = g->no_effects;
    g->no_effects = true;
    if (random_once_in(g, 2))
        random_put(g, "%d", random_below(g, 4));
    else
        random_expression(g, TYPE_FLOAT, 1, is_uniform);
    g->no_effects = outer;
}

/* A variable of another format, as it is or cast, or a number: one that the format holds, or any.
 */
static void fixed_leaf(generator *g, enum ast_type type, bool is_uniform) {
    const struct random_variable *v = find(g, random_fixed(g), is_uniform, false, 0);
    const struct fixed_format f = ast_type_format(type);
    const double range = fmin(ldexp(1, f.size - f.exponent), 1e38);
    if (v && random_once_in(g, 2))
        random_put(g, "%s", v->name);
    else if (v && random_once_in(g, 2))
        random_put(g, "(%s %s)", random_type_word(type), v->name);
    else if (random_once_in(g, 2))
        random_put(g, "(%s %.6g)", random_type_word(type),
                   range * (f.is_unsigned ? rng_unit(&g->rng) : rng_unit(&g->rng) - 0.5));
    else
        literal(g);
}

static void leaf(generator *g, enum ast_type type, bool is_uniform) {
    const struct random_variable *v =
        random_once_in(g, 4) ? NULL : find(g, type, is_uniform, false, 0);
    if (v) {
        random_put(g, "%s", v->name);
    } else if (type == TYPE_FLOAT) {
        literal(g);
    } else if (ast_type_is_fixed(type)) {
        fixed_leaf(g, type, is_uniform);
    } else if (type == TYPE_MATRIX) {
        random_put(g, "matrix ");
        literal(g);
    } else {
        random_put(g, "%s (", random_type_word(type));
        for (int i = 0; i < 3; i++) {
            random_put(g, i ? ", " : "");
            leaf(g, TYPE_FLOAT, is_uniform);
        }
        random_put(g, ")");
    }
}

/* `text` with $f a float, $t a triple of the type at hand, $g any geometric triple, $v vector,
 * $n normal, $p point, $c color, $m matrix, $x any fixed-point, $F the fixed-point type at hand
 * itself, $? a condition. */
static void fill(generator *g, const char *text, enum ast_type type, int depth, bool is_uniform) {
    static const char letters[] = "fvnpcmtgx";
    for (; *text; text++) {
        if (*text != '$') {
            random_put(g, "%c", *text);
            continue;
        }
        const enum ast_type types[] = {
            TYPE_FLOAT,     TYPE_VECTOR, TYPE_NORMAL, TYPE_POINT,
            TYPE_COLOR,     TYPE_MATRIX, type,        TYPE_POINT + random_below(g, 3),
            random_fixed(g)};
        text++;
        if (*text == 'F')
            random_put(g, "%s", random_type_word(type));
        else if (*text == '?')
            random_condition(g, depth - 1, is_uniform);
        else
            random_expression(g, types[strchr(letters, *text) - letters], depth - 1, is_uniform);
    }
}

static const char *space(generator *g, bool is_uniform) {
    const struct random_variable *v = find(g, TYPE_STRING, is_uniform, false, 0);
    if (v && random_once_in(g, 2))
        return v->name;
    return PICK(g, "\"world\"", "\"object\"", "\"shader\"");
}

static bool assignment(generator *g, enum ast_type type, int depth) {
    const struct random_variable *v = random_target(g, type);
    if (!v)
        return false;
    random_put(g, "(%s %s ", v->name,
               type == TYPE_MATRIX ? PICK(g, "=", "*=") : PICK(g, "=", "+=", "-=", "*=", "/="));
    random_expression(g, type, depth - 1, false);
    random_put(g, ")");
    return true;
}

/* A triple from an array of three. */
static bool from_array(generator *g, enum ast_type type, bool is_uniform) {
    const struct random_variable *v =
        random_array(g, random_once_in(g, 2) ? random_fixed(g) : TYPE_FLOAT, false, is_uniform);
    if (!v || v->length != 3 || v->is_open || !ast_type_is_triple(type))
        return false;
    random_put(g, "(%s %s)", random_type_word(type), v->name);
    return true;
}

static bool element(generator *g, enum ast_type type, bool is_uniform) {
    const struct random_variable *v = random_array(g, type, false, is_uniform);
    if (!v)
        return false;
    random_put(g, "%s[", v->name);
    random_index(g, is_uniform);
    random_put(g, "]");
    return true;
}

static void spline(generator *g, enum ast_type type, int depth, bool is_uniform) {
    static const struct {
        const char *name;
        int step;
    } bases[] = {{"", 1},
                 {"\"catmull-rom\", ", 1},
                 {"\"bspline\", ", 1},
                 {"\"linear\", ", 1},
                 {"\"hermite\", ", 2},
                 {"\"bezier\", ", 3}};
    int which = random_below(g, 6), count = 4 + bases[which].step * random_below(g, 3);
    const struct random_variable *array =
        bases[which].step == 1 ? random_array(g, type, false, is_uniform) : NULL;
    random_put(g, "spline(%s", bases[which].name);
    random_expression(g, TYPE_FLOAT, depth - 1, is_uniform);
    if (array && array->length >= 4 && random_once_in(g, 2)) {
        random_put(g, ", %s)", array->name);
        return;
    }
    for (int i = 0; i < count; i++) {
        random_put(g, ", ");
        leaf(g, type, is_uniform);
    }
    random_put(g, ")");
}

/* A variable or an element; there is one. */
static void output_argument(generator *g, enum ast_type type) {
    const struct random_variable *v = random_target(g, type),
                                 *array = random_array(g, type, true, false);
    if (!array || (v && !random_once_in(g, 3))) {
        random_put(g, "%s", v->name);
        return;
    }
    random_put(g, "%s[", array->name);
    random_index(g, false);
    random_put(g, "]");
}

/* An array for a parameter, which the function takes to be of this length at least. */
static const struct random_variable *array_argument(generator *g, const struct random_function *f,
                                                    int i) {
    return find(g, f->formals[i].type, false, f->is_output[i], f->formals[i].length);
}

/* Whether there is something to write to for each output parameter. */
static bool has_targets(generator *g, const struct random_function *f) {
    for (int i = 0; i < f->formal_count; i++) {
        const struct random_variable *formal = &f->formals[i];
        if (formal->length && !array_argument(g, f, i))
            return false;
        if (!formal->length && f->is_output[i] && !random_target(g, formal->type) &&
            !random_array(g, formal->type, true, false))
            return false;
    }
    return true;
}

bool random_call_of(generator *g, const struct random_function *f, int depth) {
    if ((f->has_illuminance && g->in_illuminance) || g->no_effects || !has_targets(g, f))
        return false;
    g->cost += f->cost;
    g->uses_illuminance |= f->has_illuminance;
    random_put(g, "%s(", f->name);
    for (int i = 0; i < f->formal_count; i++) {
        const struct random_variable *formal = &f->formals[i];
        random_put(g, i ? ", " : "");
        if (formal->length)
            random_put(g, "%s", array_argument(g, f, i)->name);
        else if (f->is_output[i])
            output_argument(g, formal->type);
        else
            random_expression(g, formal->type, depth - 1, formal->is_uniform);
    }
    random_put(g, ")");
    return true;
}

bool random_call(generator *g, enum ast_type type, int depth) {
    const struct random_function *f = NULL;
    int fitting = 0;
    for (int i = 0; i < g->function_count; i++)
        if (g->functions[i].type == type && g->cost + g->functions[i].cost < g->cost_max &&
            random_once_in(g, ++fitting))
            f = &g->functions[i];
    return f && random_call_of(g, f, depth);
}

void random_condition(generator *g, int depth, bool is_uniform) {
    const struct random_variable *v;
    enum ast_type type;
    g->cost++;
    switch (random_below(g, depth > 0 ? 14 : 5)) {
    case 12:
    case 13:
        random_put(g, "(");
        random_expression(g, random_fixed(g), depth - 1, is_uniform);
        random_put(g, " %s ", PICK(g, "<", ">", "<=", ">=", "==", "!="));
        random_expression(g, random_fixed(g), depth - 1, is_uniform);
        random_put(g, ")");
        return;
    case 8:
    case 9:
        random_put(g, "(");
        random_condition(g, depth - 1, is_uniform);
        random_put(g, " %s ", PICK(g, "&&", "||", "==", "!="));
        random_condition(g, depth - 1, is_uniform);
        random_put(g, ")");
        return;
    case 10:
        random_put(g, "!");
        random_condition(g, depth - 1, is_uniform);
        return;
    case 7:
        type = random_triple(g);
        random_put(g, "(");
        random_expression(g, type, depth - 1, is_uniform);
        random_put(g, " %s ", PICK(g, "==", "!="));
        random_expression(g, type, depth - 1, is_uniform);
        random_put(g, ")");
        return;
    case 6:
        v = find(g, TYPE_STRING, is_uniform, false, 0);
        if (v) {
            random_put(g, "(%s %s \"%s\")", v->name, PICK(g, "==", "!="),
                       PICK(g, "world", "shader", "other"));
            return;
        } /* fall through */
    default:
        random_put(g, "(");
        random_expression(g, TYPE_FLOAT, depth - 1, is_uniform);
        random_put(g, " %s ", PICK(g, "<", ">", "<=", ">=", "==", "!="));
        if (random_once_in(g, 5))
            random_put(g, "0");
        else
            random_expression(g, TYPE_FLOAT, depth - 1, is_uniform);
        random_put(g, ")");
    }
}

static const char *const float_forms[] = {
    "($f + $f)",
    "($f - $f)",
    "($f * $f)",
    "($f / $f)",
    "($f + $f)",
    "($f - $f)",
    "($f * $f)",
    "(-$f)",
    "($f * 0)",
    "($f + 0)",
    "($f - 0)",
    "(0 - $f)",
    "($f * 1)",
    "($f == 0 ? $f : $f)",
    "radians($f)",
    "degrees($f)",
    "sin($f)",
    "cos($f)",
    "tan($f)",
    "asin($f)",
    "acos($f)",
    "atan($f)",
    "atan($f, $f)",
    "pow($f, $f)",
    "exp($f)",
    "sqrt($f)",
    "inversesqrt($f)",
    "log($f)",
    "log($f, $f)",
    "mod($f, $f)",
    "abs($f)",
    "sign($f)",
    "min($f, $f)",
    "max($f, $f)",
    "min($f, $f, $f)",
    "max($f, $f, $f, $f)",
    "clamp($f, $f, $f)",
    "mix($f, $f, $f)",
    "floor($f)",
    "ceil($f)",
    "round($f)",
    "step($f, $f)",
    "smoothstep($f, $f, $f)",
    "(float noise($f))",
    "(float noise($f, $f))",
    "(float noise($g))",
    "(float noise($p, $f))",
    "(float cellnoise($f))",
    "(float cellnoise($f, $f))",
    "(float cellnoise($p))",
    "(float cellnoise($p, $f))",
    "(float pnoise($f, $f))",
    "(float pnoise($f, $f, $f, $f))",
    "(float pnoise($p, $p))",
    "(float pnoise($p, $f, $p, $f))",
    "xcomp($c)",
    "ycomp($v)",
    "zcomp($p)",
    "comp($c, $f)",
    "comp($n, $f)",
    "comp($v, 1)",
    "length($v)",
    "distance($p, $p)",
    "($v . $n)",
    "($c . $c)",
    "ptlined($p, $p, $p)",
    "determinant($m)",
    "comp($m, $f, $f)",
    "comp($m, 3, $f)",
    "($? ? $f : $f)",
    "($? ? $f : $f)",
    "($? * $f)",
    "($f + $?)",
};

/* In a program without fixed-point these are floats, too. */
static const char *const mixed_forms[] = {
    "(float ($f + $x))",
    "(float ($x * $f))",
    "(float ($x / $x))",
    "(float ($x % $x))",
    "(float $x)",
    "(float $x)",
    "($f % $f)",
    "sin($x)",
    "(float abs($x))",
    "(float max($x, $f))",
    "(float ($? ? $x : $f))",
    "comp($c, $x)",
    "(float noise($x, $x))",
    "(float mix($f, $f, $x))",
};

static const char *const fixed_forms[] = {
    "($x + $x)",
    "($x - $x)",
    "($x * $x)",
    "($x / $x)",
    "($x % $x)",
    "($x + $x)",
    "($x - $x)",
    "($x * $x)",
    "(-$x)",
    "($x + $f)",
    "($x * 2)",
    "($x * 0.5)",
    "($x - 0.25)",
    "($x + 1000000)",
    "($x / 3)",
    "($x % 4)",
    "(1 - $x)",
    "($F $x)",
    "($F $x)",
    "($F $f)",
    "($F ($?))",
    "mod($x, $x)",
    "min($x, $x)",
    "max($x, $x, $x)",
    "clamp($x, $x, $x)",
    "clamp($x, 0, 1)",
    "mix($x, $x, $x)",
    "abs($x)",
    "sign($x)",
    "floor($x)",
    "ceil($x)",
    "round($x)",
    "sqrt($x)",
    "step($x, $x)",
    "step(0.5, $x)",
    "noise($x)",
    "noise($x, $x)",
    "noise(($F $x), ($F $x), ($F $x))",
    "($? ? $x : $x)",
    "($? ? $x : 1)",
    "($x * $?)",
    "($x + $?)",
};

static const char *const triple_forms[] = {
    "($t + $t)",       "($t - $t)",      "($t * $t)",       "($t / $t)",
    "($t * $f)",       "($f * $t)",      "($t / $f)",       "($f - $t)",
    "(-$t)",           "min($t, $t)",    "max($t, $t, $t)", "clamp($t, $t, $t)",
    "mix($t, $t, $f)", "($? ? $t : $t)", "($? ? $t : $t)",  "($t + ($f, $f, $f))",
    "($t + 0)",
};

static const char *const color_forms[] = {
    "color ($f, $f, $f)",
    "color (noise($f))",
    "(color noise($f))",
    "(color noise($f, $f))",
    "(color noise($p))",
    "(color noise($p, $f))",
    "(color cellnoise($p))",
    "(color pnoise($p, $p))",
    "(color pnoise($f, $f))",
    "(color pnoise($p, $f, $p, $f))",
    "color ($v)",
    "color \"hsv\" ($f, $f, $f)",
    "color \"hsl\" ($f, $f, $f)",
    "color \"YIQ\" ($f, $f, $f)",
    "color \"xyz\" $c",
    "ctransform(\"hsv\", $c)",
    "ctransform(\"xyz\", \"hsl\", $c)",
    "ctransform(\"rgb\", \"YIQ\", $c)",
    "mix($c, $c, $c)",
    "specularbrdf($v, $n, $v, $f)",
};

static const char *const geometric_forms[] = {
    "point ($f, $f, $f)",
    "vector ($f, $f, $f)",
    "normal ($f, $f, $f)",
    "normalize($v)",
    "normalize($n)",
    "($g ^ $g)",
    "faceforward($v, $v)",
    "faceforward($n, $v, $n)",
    "reflect($v, $n)",
    "refract($v, $n, $f)",
    "rotate($p, $f, $p, $p)",
    "(vector noise($f))",
    "(point noise($p))",
    "(point noise($p, $f))",
    "(vector cellnoise($f, $f))",
    "(point pnoise($p, $p))",
    "transform($m, $p)",
    "vtransform($m, $v)",
    "ntransform($m, $n)",
    "vector ($c)",
    "($p - $p)",
    "point \"world\" ($f, $f, $f)",
    "vector \"object\" $v",
    "normal \"shader\" $n",
};

static const char *const matrix_forms[] = {
    "($m * $m)",
    "($m / $m)",
    "($f * $m)",
    "($m / $f)",
    "translate($m, $v)",
    "scale($m, $v)",
    "rotate($m, $f, $v)",
    "matrix $f",
    "matrix \"world\" $f",
    "($? ? $m : $m)",
    "matrix ($f, $f, $f, $f, $f, $f, $f, $f, $f, $f, $f, $f, $f, $f, $f, $f)",
    "matrix \"shader\" ($f, $f, $f, 1, $f, $f, $f, 2, $f, $f, $f, 3, $f, $f, $f, 1)",
};

static void transformation(generator *g, enum ast_type type, int depth, bool is_uniform) {
    bool is_between = random_once_in(g, 3);
    random_put(g, "%s(",
               type == TYPE_POINT    ? "transform"
               : type == TYPE_VECTOR ? "vtransform"
                                     : "ntransform");
    if (is_between)
        random_put(g, "%s",
                   PICK(g, "\"world\", \"shader\", ", "\"shader\", \"object\", ",
                        "\"object\", \"world\", ", "\"object\", \"camera\", "));
    else
        random_put(g, "%s, ", space(g, is_uniform));
    random_expression(g, type, depth - 1, is_uniform);
    random_put(g, ")");
}

/* What only some types and places have; false when nothing was written. */
static bool special(generator *g, enum ast_type type, int depth, bool is_uniform) {
    static const char *const lit[] = {"diffuse($n)", "specular($n, $v, $f)", "phong($n, $v, $f)"};
    bool is_surface = !g->program->is_light;
    switch (random_below(g, 7)) {
    case 0:
        return !is_uniform && assignment(g, type, depth);
    case 1:
    case 2:
    case 6:
        return !is_uniform && random_call(g, type, depth);
    case 3:
        return from_array(g, type, is_uniform) || element(g, type, is_uniform);
    case 4:
        if (type == TYPE_MATRIX || ast_type_is_fixed(type))
            return false;
        spline(g, type, depth, is_uniform);
        return true;
    default:
        if (ast_type_is_geometric(type)) {
            transformation(g, type, depth, is_uniform);
            return true;
        }
        if (is_uniform || type == TYPE_MATRIX || ast_type_is_fixed(type))
            return false;
        if (type == TYPE_COLOR && is_surface && random_once_in(g, 2)) {
            if (g->in_illuminance || random_once_in(g, 2)) {
                random_put(g, "ambient()");
                return true;
            }
            g->uses_illuminance = true;
            g->cost += 20;
            fill(g, lit[random_below(g, 3)], type, depth, false);
            return true;
        }
        random_put(g, "(%s random())", random_type_word(type));
        return true;
    }
}

void random_expression(generator *g, enum ast_type type, int depth, bool is_uniform) {
    g->cost++;
    if (depth <= 0 || g->cost > g->cost_max || random_once_in(g, 6)) {
        leaf(g, type, is_uniform);
        return;
    }
    if (random_once_in(g, 4) && special(g, type, depth, is_uniform))
        return;
#define FORM(list)                                                                                 \
    fill(g, list[random_below(g, (int)(sizeof list / sizeof *list))], type, depth, is_uniform)
    g->cost += type == TYPE_MATRIX ? 10 : type == TYPE_FLOAT ? 0 : 2;
    if (type == TYPE_FLOAT && random_once_in(g, g->format_count ? 4 : 20))
        FORM(mixed_forms);
    else if (type == TYPE_FLOAT)
        FORM(float_forms);
    else if (ast_type_is_fixed(type))
        FORM(fixed_forms);
    else if (type == TYPE_MATRIX)
        FORM(matrix_forms);
    else if (random_once_in(g, 2))
        FORM(triple_forms);
    else if (type == TYPE_COLOR)
        FORM(color_forms);
    else
        FORM(geometric_forms);
#undef FORM
}
