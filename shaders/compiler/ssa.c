/* SPDX-License-Identifier: Apache-2.0 */
#include "shaders/compiler/passes.h"

#include <string.h>

/* Static single assignment with the phi-related temporaries merged again (PF section 6.3.3,
 * figure 10): every assignment begins a new name, names that meet at a use through a phi-function
 * become one, and each of the resulting webs is a variable of its own. A variable that is used
 * independently in two places takes no pixel memory between them, and most variables end up
 * assigned once, which is what the passes after this one work on.
 *
 * Control flow is structured, so phi-functions belong at the ends of ifs and the heads of loops.
 * One is only made real ("demanded") when something reads it. A web whose value is never that of
 * the declaration moves into the innermost list that holds all its definitions and uses: there,
 * samples that do not take part need not keep anything. Arrays are left alone. */

struct web {
    struct web *root; /* union-find */
    struct ir_variable *original, *variable;
    struct web *arguments[2];     /* of a phi */
    const struct ir_node *phi_of; /* the control flow that a phi ends or heads */
    bool is_phi, is_demanded;
    bool is_pinned;        /* holds the zero of the declaration, or must stay where it is */
    struct ir_list *where; /* holds all definitions and uses so far; NULL: none yet */
};

/* A place that names a variable, to be rewritten. */
struct web_place {
    struct ir_operand *operand;
    struct ir_variable **slot;
    struct web *web;
};

struct changed {
    struct ir_variable *variable;
    struct web *before;
};

struct renaming {
    struct ir_program *ir;
    struct web **current; /* by variable id */
    struct web **other;   /* likewise: the names that the second of two paths leaves behind */
    struct web_place *places;
    size_t place_count, place_capacity;
    struct changed *log; /* assignments, in order; truncated when a list has been dealt with */
    size_t log_count, log_capacity;
    struct web **webs;
    size_t web_count, web_capacity;
};

/* Arena arrays that grow: the old copy stays behind until the compilation ends. */
static void *grown(struct renaming *r, void *old, size_t count, size_t *capacity, size_t size) {
    if (count < *capacity)
        return old;
    const size_t more = *capacity ? *capacity * 2 : 256;
    void *fresh = compilation_get(r->ir->c, more * size);
    if (count)
        memcpy(fresh, old, count * size);
    *capacity = more;
    return fresh;
}

static struct web *new_web(struct renaming *r, struct ir_variable *original) {
    struct web *web = compilation_get(r->ir->c, sizeof *web);
    web->root = web;
    web->original = original;
    r->webs = grown(r, r->webs, r->web_count, &r->web_capacity, sizeof *r->webs);
    r->webs[r->web_count++] = web;
    return web;
}

static struct web *root_of(struct web *web) {
    while (web->root != web) {
        web->root = web->root->root;
        web = web->root;
    }
    return web;
}

static int depth_of(const struct ir_list *list) {
    int depth = 0;
    for (; list->owner; list = list->owner->list)
        depth++;
    return depth;
}

static struct ir_list *common_list(struct ir_list *a, struct ir_list *b) {
    if (!a || !b)
        return a ? a : b;
    int deep_a = depth_of(a), deep_b = depth_of(b);
    for (; deep_a > deep_b; deep_a--)
        a = a->owner->list;
    for (; deep_b > deep_a; deep_b--)
        b = b->owner->list;
    while (a != b) {
        a = a->owner->list;
        b = b->owner->list;
    }
    return a;
}

static void unite(struct web *a, struct web *b) {
    a = root_of(a);
    b = root_of(b);
    if (a == b)
        return;
    b->root = a;
    a->is_pinned |= b->is_pinned;
    a->where = common_list(a->where, b->where);
}

/* Somebody reads the web: phi-functions behind it become real. */
static void demand(struct web *web) {
    if (!web->is_phi || web->is_demanded)
        return;
    web->is_demanded = true;
    for (int i = 0; i < 2; i++)
        if (web->arguments[i]) {
            demand(web->arguments[i]);
            unite(web, web->arguments[i]);
        }
}

static struct web *new_phi(struct renaming *r, struct ir_variable *original, struct web *a,
                           struct web *b) {
    struct web *phi = new_web(r, original);
    phi->is_phi = true;
    phi->arguments[0] = a;
    phi->arguments[1] = b;
    return phi;
}

static void set_current(struct renaming *r, struct ir_variable *variable, struct web *web) {
    r->log = grown(r, r->log, r->log_count, &r->log_capacity, sizeof *r->log);
    r->log[r->log_count++] = (struct changed){variable, r->current[variable->id]};
    r->current[variable->id] = web;
}

static void add_place(struct renaming *r, struct ir_operand *operand, struct ir_variable **slot,
                      struct web *web, struct ir_list *list) {
    struct web *root = root_of(web);
    root->where = common_list(root->where, list);
    r->places = grown(r, r->places, r->place_count, &r->place_capacity, sizeof *r->places);
    r->places[r->place_count++] = (struct web_place){operand, slot, web};
}

static void read_operand(struct renaming *r, struct ir_operand *operand, struct ir_list *list) {
    if (operand->kind != OPERAND_VARIABLE || operand->variable->array_length)
        return;
    struct web *web = r->current[operand->variable->id];
    demand(web);
    add_place(r, operand, NULL, web, list);
}

static void rename_instruction(struct renaming *r, struct ir_node *node) {
    for (int i = 0; i < IR_OPERANDS_MAX; i++)
        read_operand(r, &node->operands[i], node->list);
    for (int i = 0; i < 3; i++) {
        struct ir_variable *variable = node->results[i];
        if (!variable || variable->array_length)
            continue;
        set_current(r, variable, new_web(r, variable));
        add_place(r, NULL, &node->results[i], r->current[variable->id], node->list);
    }
}

static void rename_list(struct renaming *r, struct ir_list *list);

/* The names that a list leaves behind for the variables it assigns. */
struct side {
    struct changed *changed; /* `before` holds the name left behind */
    size_t count;
};

/* Renames a list whose end need not be where the code goes on: the names from before come back. */
static struct side rename_side(struct renaming *r, struct ir_list *list) {
    const size_t begin = r->log_count;
    rename_list(r, list);
    struct side side = {.count = r->log_count - begin};
    side.changed = compilation_get(r->ir->c, (side.count + 1) * sizeof *side.changed);
    for (size_t i = 0; i < side.count; i++) {
        struct ir_variable *variable = r->log[begin + i].variable;
        side.changed[i] = (struct changed){variable, r->current[variable->id]};
    }
    for (size_t i = side.count; i-- > 0;)
        r->current[r->log[begin + i].variable->id] = r->log[begin + i].before;
    r->log_count = begin;
    return side;
}

static bool is_declared_inside(const struct ir_variable *variable, const struct ir_node *node) {
    for (const struct ir_list *list = variable->home; list->owner; list = list->owner->list)
        if (list->owner == node)
            return true;
    return false;
}

/* Both sides start from the same names; where they end with different ones there is a phi. */
static void rename_if(struct renaming *r, struct ir_node *node) {
    read_operand(r, &node->condition, node->list);
    const struct side sides[2] = {rename_side(r, node->body), rename_side(r, node->otherwise)};
    for (size_t i = 0; i < sides[1].count; i++)
        r->other[sides[1].changed[i].variable->id] = sides[1].changed[i].before;
    for (int s = 0; s < 2; s++)
        for (size_t i = 0; i < sides[s].count; i++) {
            struct ir_variable *variable = sides[s].changed[i].variable;
            struct web *before = r->current[variable->id], *left = sides[s].changed[i].before;
            struct web *other = s ? before : r->other[variable->id];
            const bool is_done = before->phi_of == node;
            if (is_declared_inside(variable, node) || is_done)
                continue;
            struct web *phi = new_phi(r, variable, left, other ? other : before);
            phi->phi_of = node;
            set_current(r, variable, phi);
        }
    for (size_t i = 0; i < sides[1].count; i++)
        r->other[sides[1].changed[i].variable->id] = NULL;
}

struct loop_scan {
    struct renaming *r;
    struct ir_node *loop;
};

/* Puts a phi at the head of the loop for a variable from outside that it assigns. */
static void add_head(struct ir_variable *variable, void *context) {
    struct loop_scan *scan = context;
    struct web *before = scan->r->current[variable->id];
    if (variable->array_length || is_declared_inside(variable, scan->loop) ||
        before->phi_of == scan->loop)
        return;
    struct web *phi = new_phi(scan->r, variable, before, NULL);
    phi->phi_of = scan->loop;
    set_current(scan->r, variable, phi);
}

static void scan_node(struct ir_node *node, void *context) {
    ir_each_write(node, add_head, context);
}

/* A loop leaves after its test, an illuminance at its head; what the body leaves behind comes round
 * to the head again. */
static void rename_loop(struct renaming *r, struct ir_node *node) {
    const size_t heads = r->log_count;
    struct loop_scan scan = {r, node};
    ir_each_node(node->test, scan_node, &scan);
    ir_each_node(node->body, scan_node, &scan);
    const size_t end = r->log_count;
    struct web **phis = compilation_get(r->ir->c, (end - heads + 1) * sizeof *phis);
    for (size_t i = heads; i < end; i++)
        phis[i - heads] = r->current[r->log[i].variable->id];
    rename_list(r, node->test);
    if (node->kind == NODE_LOOP)
        read_operand(r, &node->condition, node->test);
    const struct side body = rename_side(r, node->body);
    for (size_t i = 0; i < body.count; i++)
        r->other[body.changed[i].variable->id] = body.changed[i].before;
    for (size_t i = heads; i < end; i++) {
        struct web *phi = phis[i - heads];
        const int id = r->log[i].variable->id;
        struct web *round = r->other[id] ? r->other[id] : r->current[id];
        phi->arguments[1] = round;
        if (phi->is_demanded) {
            demand(round);
            unite(phi, round);
        }
    }
    for (size_t i = 0; i < body.count; i++)
        r->other[body.changed[i].variable->id] = NULL;
}

static void rename_list(struct renaming *r, struct ir_list *list) {
    for (struct ir_variable *v = list ? list->variables : NULL; v; v = v->next_in_home) {
        r->current[v->id] = new_web(r, v);
        r->current[v->id]->is_pinned = true;
    }
    for (struct ir_node *node = list ? list->first : NULL; node; node = node->next) {
        if (node->kind == NODE_INSTRUCTION)
            rename_instruction(r, node);
        else if (node->kind == NODE_IF)
            rename_if(r, node);
        else
            rename_loop(r, node);
    }
}

/* The variable of a web: the first web of an original keeps it, others get copies of it. */
static struct ir_variable *variable_of(struct renaming *r, struct web *web) {
    struct web *root = root_of(web);
    if (root->variable)
        return root->variable;
    struct ir_variable *original = root->original;
    if (!original->is_renamed) {
        original->is_renamed = true;
        return root->variable = original;
    }
    struct ir_variable *fresh =
        ir_variable_new(r->ir, original->home, original->type, original->name);
    fresh->format = original->format;
    fresh->is_temporary = original->is_temporary;
    fresh->is_declared_uniform = original->is_declared_uniform;
    fresh->is_forced_varying = original->is_forced_varying;
    fresh->is_renamed = true;
    fresh->is_loaded = original->is_loaded;
    fresh->declared = original->declared ? original->declared : original;
    return root->variable = fresh;
}

static void move_home(struct ir_variable *variable, struct ir_list *home) {
    struct ir_variable **link = &variable->home->variables;
    while (*link != variable)
        link = &(*link)->next_in_home;
    *link = variable->next_in_home;
    variable->home = home;
    variable->next_in_home = home->variables;
    home->variables = variable;
}

static void rename_places(struct renaming *r) {
    for (size_t i = 0; i < r->place_count; i++) {
        struct ir_variable *variable = variable_of(r, r->places[i].web);
        if (r->places[i].slot)
            *r->places[i].slot = variable;
        else
            r->places[i].operand->variable = variable;
    }
}

/* Where a declaration says uniform or varying, it stays where it is: what may be assigned there is
 * the user's word. */
static void move_homes(struct renaming *r) {
    for (size_t i = 0; i < r->web_count; i++) {
        struct web *web = r->webs[i];
        struct ir_variable *variable = web->variable;
        if (web->root != web || !variable || web->is_pinned || !web->where ||
            variable->is_declared_uniform || variable->is_forced_varying)
            continue;
        if (web->where != variable->home)
            move_home(variable, web->where);
    }
}

void pass_ssa(struct ir_program *ir) {
    struct renaming renaming = {.ir = ir}, *r = &renaming;
    struct ir_variable *results[IR_RESULTS_MAX];
    const int count = ir_results(ir, results);
    const size_t variables = ir->variable_count + 1;
    r->current = compilation_get(ir->c, variables * sizeof *r->current);
    r->other = compilation_get(ir->c, variables * sizeof *r->other);
    rename_list(r, ir->top);
    struct web *final[IR_RESULTS_MAX];
    for (int i = 0; i < count; i++) {
        final[i] = r->current[results[i]->id];
        demand(final[i]);
        root_of(final[i])->where = common_list(root_of(final[i])->where, ir->top);
        root_of(final[i])->is_pinned = true;
    }
    rename_places(r);
    struct ir_variable *renamed[IR_RESULTS_MAX];
    for (int i = 0; i < count; i++)
        renamed[i] = variable_of(r, final[i]);
    ir_set_results(ir, renamed);
    move_homes(r);
}
