/* SPDX-License-Identifier: Apache-2.0 */
#include "shaders/compiler/emit.h"

/* Predication: in varying control flow a mask says for which samples the code runs; assignments to
 * variables of the outside are blended. A body is skipped when no sample is active, unless
 * something in it must report its trips: the array would issue it all the same. */

enum { SKIP_WORTH = 4 }; /* instructions that make a test of the mask worth its while */

static int node_count(const struct ir_list *list, int limit) {
    int count = 0;
    for (const struct ir_node *node = list ? list->first : NULL; node && count < limit;
         node = node->next)
        count += node->kind == NODE_INSTRUCTION ? 1 : limit;
    return count;
}

static void open(struct emitter *e, const char *text) {
    emit_line(e, "%s", text);
    e->indent++;
}

static void close(struct emitter *e) {
    e->indent--;
    emit_line(e, "}");
}

/* Starts the control path of an entry into `block`. */
static int emit_key(struct emitter *e, int block) {
    int key = e->next_number++;
    emit_line(e, "const uint64_t k%d SHADER_UNUSED = shader_key(k%d, %du);", key, e->key,
              (unsigned)block);
    return key;
}

/* Reports trips; where all vectors of the call do the same, the first speaks for all. */
static void emit_report(struct emitter *e, int block, int key, bool is_uniform, const char *trips,
                        int number) {
    const char *counters = e->in_light ? "self->counters" : "call->counters";
    const char *when = is_uniform && !e->in_light && !e->in_varying_loop ? "if (at == 0) " : "";
    if (number >= 0)
        emit_line(e, "%sshader_report(%s, %du, k%d, %s%d);", when, counters, (unsigned)block, key,
                  trips, number);
    else
        emit_line(e, "%sshader_report(%s, %du, k%d, %s);", when, counters, (unsigned)block, key,
                  trips);
}

static void emit_side(struct emitter *e, struct ir_node *node, struct ir_list *list, int mask) {
    int outer = e->mask;
    e->mask = mask;
    bool skips = !node->has_blocks && node_count(list, SKIP_WORTH) >= SKIP_WORTH;
    if (skips) {
        emit_line(e, "if (vi_any(m%d)) {", mask);
        e->indent++;
    } else {
        open(e, "{");
    }
    emit_list(e, list);
    close(e);
    e->mask = outer;
}

static void emit_varying_if(struct emitter *e, struct ir_node *node) {
    int condition = e->next_number++, mask = e->next_number++, inverse = e->next_number++;
    emit_text(e, "%*s", e->indent * 4, "");
    emit_text(e, "const vi m%d = ", condition);
    emit_operand(e, &node->condition, true);
    emit_text(e, ";\n");
    if (e->mask >= 0)
        emit_line(e, "const vi m%d = m%d & m%d;", mask, e->mask, condition);
    else
        emit_line(e, "const vi m%d = m%d;", mask, condition);
    emit_side(e, node, node->body, mask);
    if (!node->otherwise || !node->otherwise->first)
        return;
    if (e->mask >= 0)
        emit_line(e, "const vi m%d = m%d & ~m%d;", inverse, e->mask, condition);
    else
        emit_line(e, "const vi m%d = ~m%d;", inverse, condition);
    emit_side(e, node, node->otherwise, inverse);
}

static void emit_branch(struct emitter *e, struct ir_list *list, int block) {
    int key = e->key;
    if (block >= 0 && !e->in_prepare) {
        e->key = emit_key(e, block);
        emit_report(e, block, e->key, true, "1", -1);
    }
    emit_list(e, list);
    e->key = key;
}

static void emit_uniform_if(struct emitter *e, struct ir_node *node) {
    emit_text(e, "%*sif (", e->indent * 4, "");
    emit_operand(e, &node->condition, false);
    emit_text(e, ") {\n");
    e->indent++;
    emit_branch(e, node->body, node->block);
    if (node->otherwise && node->otherwise->first) {
        e->indent--;
        emit_line(e, "} else {");
        e->indent++;
        emit_branch(e, node->otherwise, node->block_otherwise);
    }
    close(e);
}

/* A loop over uniform values. Steps of all uniform loops together are limited; inside a varying
 * loop they count as steps of its samples, too, so that no nest of loops runs for ever. */
static void emit_uniform_loop(struct emitter *e, struct ir_node *node) {
    int number = e->next_number++, entry = -1, key = e->key;
    if (node->block >= 0)
        entry = emit_key(e, node->block);
    emit_line(e, "uint64_t n%d = 0;", number);
    open(e, "for (;;) {");
    emit_list(e, node->test);
    emit_text(e, "%*sif (!(", e->indent * 4, "");
    emit_operand(e, &node->condition, false);
    emit_text(e, "))\n");
    emit_line(e, "    break;");
    emit_line(e, "if (++w%d > SHADER_LOOP_LIMIT) {", e->steps);
    emit_line(e, "    %s = 1;",
              e->in_prepare ? "overrun"
              : e->in_light ? "*overrun"
                            : "call->overrun");
    emit_line(e, "    break;");
    emit_line(e, "}");
    emit_line(e, "n%d++;", number);
    if (node->has_blocks && entry >= 0) {
        e->key = e->next_number++;
        emit_line(e, "const uint64_t k%d SHADER_UNUSED = shader_key(k%d, n%d);", e->key, entry,
                  number);
    }
    emit_list(e, node->body);
    close(e);
    e->key = key;
    if (entry >= 0)
        emit_report(e, node->block, entry, true, "n", number);
    else
        emit_line(e, "(void)n%d;", number);
    if (e->loop_mask >= 0)
        emit_line(e, "steps += vi_set((int32_t)n%d) & m%d;", number, e->loop_mask);
}

static void emit_varying_loop(struct emitter *e, struct ir_node *node) {
    struct emitter outer = *e;
    int number = e->next_number++, mask = e->next_number++, over = e->next_number++;
    int entry = emit_key(e, node->block);
    emit_line(e, "uint64_t n%d = 0;", number);
    if (e->mask >= 0)
        emit_line(e, "vi m%d = m%d;", mask, e->mask);
    else
        emit_line(e, "vi m%d = vi_set(-1);", mask);
    open(e, "for (;;) {");
    e->mask = e->loop_mask = mask;
    e->in_varying_loop++;
    emit_list(e, node->test);
    emit_text(e, "%*sm%d &= ", e->indent * 4, "", mask);
    emit_operand(e, &node->condition, true);
    emit_text(e, ";\n");
    emit_line(e, "const vi m%d = m%d & (steps >= vi_set(SHADER_LOOP_LIMIT));", over, mask);
    emit_line(e, "if (vi_any(m%d)) {", over);
    emit_line(e, "    %s = 1;", e->in_light ? "*overrun" : "call->overrun");
    emit_line(e, "    m%d &= ~m%d;", mask, over);
    emit_line(e, "}");
    emit_line(e, "if (!vi_any(m%d))", mask);
    emit_line(e, "    break;");
    emit_line(e, "steps -= m%d;", mask);
    emit_line(e, "n%d++;", number);
    e->steps = e->next_number++;
    emit_line(e, "uint64_t w%d SHADER_UNUSED = 0;", e->steps);
    if (node->has_blocks) {
        e->key = e->next_number++;
        emit_line(e, "const uint64_t k%d SHADER_UNUSED = shader_key(k%d, n%d);", e->key, entry,
                  number);
    }
    emit_list(e, node->body);
    close(e);
    outer.next_number = e->next_number;
    *e = outer;
    emit_report(e, node->block, entry, false, "n", number);
}

/* The set of results: the one that the condition was made with. */
static int light_set_of(const struct ir_node *node) {
    return node->condition.kind == OPERAND_VARIABLE ? node->light_set : 0;
}

/* One pass per directional light over what the lights left in the scratch area. */
static void emit_illuminance(struct emitter *e, struct ir_node *node) {
    struct emitter outer = *e;
    int number = e->next_number++, mask = e->next_number++;
    int entry = emit_key(e, node->block);
    emit_line(e, "uint64_t n%d = 0;", number);
    emit_line(e, "for (int i%d = 0; i%d < call->light_count; i%d++) {", number, number, number);
    e->indent++;
    emit_line(e, "if (call->lights[i%d].module->is_ambient)", number);
    emit_line(e, "    continue;");
    if (node->category >= 0) {
        emit_line(e, "if (!(call->lights[i%d].categories >> %d & 1))", number, node->category);
        emit_line(e, "    continue;");
    }
    emit_line(e, "const float *light_result SHADER_UNUSED = shader_light_result(call, %d, i%d);",
              light_set_of(node), number);
    emit_line(e, "const struct shader_light *this_light SHADER_UNUSED = &call->lights[i%d];",
              number);
    if (e->mask >= 0)
        emit_line(e, "const vi m%d = m%d & shader_load_mask(light_result + 6 * SHADER_WIDTH);",
                  mask, e->mask);
    else
        emit_line(e, "const vi m%d = shader_load_mask(light_result + 6 * SHADER_WIDTH);", mask);
    emit_line(e, "n%d++;", number);
    if (!node->has_blocks) {
        emit_line(e, "if (!vi_any(m%d))", mask);
        emit_line(e, "    continue;");
    } else {
        e->key = e->next_number++;
        emit_line(e, "const uint64_t k%d SHADER_UNUSED = shader_key(k%d, n%d);", e->key, entry,
                  number);
    }
    e->mask = mask;
    emit_list(e, node->body);
    close(e);
    outer.next_number = e->next_number;
    *e = outer;
    emit_report(e, node->block, entry, true, "n", number);
}

void emit_declaration(struct emitter *e, struct ir_variable *v) {
    static const char *const scalars[] = {"float", "int", "int32_t", "int64_t"},
                             *const vectors[] = {"vf", "vi", "int32_t", "vx"};
    const char *type = (v->is_varying ? vectors : scalars)[v->type];
    if (v->array_length)
        emit_line(e, "%s v%d[%d] = {0};", type, v->id, v->array_length);
    else
        emit_line(e, v->is_varying ? "%s v%d = {0};" : "%s v%d = 0;", type, v->id);
}

void emit_list(struct emitter *e, struct ir_list *list) {
    if (!list)
        return;
    bool is_top = !list->owner;
    for (struct ir_variable *v = list->variables; v && !is_top; v = v->next_in_home)
        emit_declaration(e, v);
    for (struct ir_node *node = list->first; node; node = node->next) {
        if (is_top && node->is_prepared != e->in_prepare)
            continue;
        if (node->kind == NODE_INSTRUCTION) {
            emit_instruction(e, node);
            emit_probes(e, node);
        } else if (node->kind == NODE_IF && node->is_varying)
            emit_varying_if(e, node);
        else if (node->kind == NODE_IF)
            emit_uniform_if(e, node);
        else if (node->kind == NODE_LOOP && node->is_varying)
            emit_varying_loop(e, node);
        else if (node->kind == NODE_LOOP)
            emit_uniform_loop(e, node);
        else
            emit_illuminance(e, node);
    }
}
