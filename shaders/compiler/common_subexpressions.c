/* SPDX-License-Identifier: Apache-2.0 */
#include "shaders/compiler/passes.h"

#include "base/hash.h"

#include <string.h>

/* Common subexpressions: an instruction that computes what an earlier one has computed becomes a
 * move of that result. Only values that do not change afterwards take part (assigned once, in the
 * list that declares them), and only instructions whose result follows from their operands. What a
 * list computes is known in it after that, in the lists inside, and nowhere else; the test of a
 * loop counts as around its body. */

enum { CSE_BUCKETS = 4096 };

struct known {
    const struct ir_node *node;
    unsigned bucket;
    struct known *below, *previous; /* in the bucket; in order of entry */
};

struct known_values {
    struct ir_program *ir;
    struct known *buckets[CSE_BUCKETS];
    struct known *newest;
};

static bool is_stable(const struct ir_operand *operand) {
    return operand->kind != OPERAND_VARIABLE || ir_variable_is_settled(operand->variable);
}

static bool takes_part(const struct ir_node *node) {
    if (ir_is_move(node) || node->operation == IR_MOVE_STRING ||
        !ir_operation_is_pure(node->operation))
        return false;
    for (int i = 0; i < IR_OPERANDS_MAX; i++)
        if (!is_stable(&node->operands[i]))
            return false;
    for (int i = 0; i < 3; i++) {
        const struct ir_variable *result = node->results[i];
        if (result && (!ir_variable_is_settled(result) || result->is_declared_uniform ||
                       result->is_forced_varying))
            return false;
    }
    return node->results[0] || node->results[1] || node->results[2];
}

static uint64_t hash_operand(const struct ir_operand *operand, uint64_t hash) {
    const uint64_t kind = operand->kind;
    hash = hash_bytes(&kind, sizeof kind, hash);
    switch (operand->kind) {
    case OPERAND_VARIABLE:
        return hash_bytes(&operand->variable->id, sizeof operand->variable->id, hash);
    case OPERAND_FLOAT:
        return hash_bytes(&operand->number, sizeof operand->number, hash);
    case OPERAND_BOOL:
    case OPERAND_STRING:
        return hash_bytes(&operand->identity, sizeof operand->identity, hash);
    case OPERAND_FIXED:
        return hash_bytes(&operand->raw, sizeof operand->raw, hash);
    case OPERAND_NONE:
        break;
    }
    return hash;
}

static unsigned bucket_of(const struct ir_node *node) {
    uint64_t hash = (uint64_t)node->operation * 64 + (uint64_t)node->index;
    for (int i = 0; i < IR_OPERANDS_MAX && node->operands[i].kind != OPERAND_NONE; i++)
        hash = hash_operand(&node->operands[i], hash);
    return (unsigned)(hash_bytes(&hash, sizeof hash, 1) % CSE_BUCKETS);
}

static bool same_operand(const struct ir_operand *a, const struct ir_operand *b) {
    if (a->kind != b->kind)
        return false;
    switch (a->kind) {
    case OPERAND_VARIABLE:
        return a->variable == b->variable;
    case OPERAND_FLOAT: /* bit for bit: 0 and -0 differ */
        return !memcmp(&a->number, &b->number, sizeof a->number);
    case OPERAND_BOOL:
        return a->truth == b->truth;
    case OPERAND_STRING:
        return a->identity == b->identity;
    case OPERAND_FIXED:
        return a->raw == b->raw && fixed_same(a->format, b->format);
    case OPERAND_NONE:
        break;
    }
    return true;
}

static bool same_results(const struct ir_node *known, const struct ir_node *node) {
    for (int i = 0; i < 3; i++) {
        if (node->results[i] && !known->results[i])
            return false;
        if (node->results[i] && node->results[i]->type == IR_FIXED &&
            !fixed_same(node->results[i]->format, known->results[i]->format))
            return false;
    }
    return true;
}

static bool is_same(const struct ir_node *known, const struct ir_node *node) {
    if (known->operation != node->operation || known->index != node->index ||
        known->parameter != node->parameter || known->external != node->external ||
        known->is_fast != node->is_fast || known->is_free != node->is_free ||
        known->is_shared != node->is_shared || !same_results(known, node))
        return false;
    const bool asks_neighbours =
        node->operation == IR_DIFFERENCE_X || node->operation == IR_DIFFERENCE_Y;
    if (asks_neighbours && known->list != node->list)
        return false; /* other neighbours may take part there */
    for (int i = 0; i < IR_OPERANDS_MAX; i++)
        if (!same_operand(&known->operands[i], &node->operands[i]))
            return false;
    return true;
}

/* `node` becomes a move of its only result; further results get moves of their own behind it. */
static void become_moves(struct known_values *k, struct ir_node *node,
                         const struct ir_node *known) {
    struct ir_variable *results[3];
    static const enum ir_operation moves[] = {
        [IR_FLOAT] = IR_MOVE, [IR_BOOL] = IR_MOVE_BOOL, [IR_FIXED] = IR_MOVE_FIXED};
    memcpy(results, node->results, sizeof results);
    struct ir_node *at = NULL;
    for (int i = 0; i < 3; i++) {
        if (!results[i])
            continue;
        struct ir_node *move = node;
        if (at) {
            move = compilation_get(k->ir->c, sizeof *move);
            *move = *node;
            move->next = at->next;
            at->next = move;
            if (node->list->last == at)
                node->list->last = move;
        }
        move->operation = moves[results[i]->type];
        memset(move->operands, 0, sizeof move->operands);
        memset(move->results, 0, sizeof move->results);
        move->operands[0] = ir_of(known->results[i]);
        move->results[0] = results[i];
        results[i]->definition = move;
        move->parameter = NULL;
        move->external = NULL;
        move->index = 0;
        move->is_free = move->is_fast = false;
        move->call_site = NULL;
        at = move;
    }
}

static void look_up(struct known_values *k, struct ir_node *node) {
    const unsigned bucket = bucket_of(node);
    for (const struct known *known = k->buckets[bucket]; known; known = known->below)
        if (is_same(known->node, node)) {
            become_moves(k, node, known->node);
            return;
        }
    struct known *entry = compilation_get(k->ir->c, sizeof *entry);
    *entry = (struct known){node, bucket, k->buckets[bucket], k->newest};
    k->buckets[bucket] = k->newest = entry;
}

static void visit_list(struct known_values *k, struct ir_list *list) {
    for (struct ir_node *node = list ? list->first : NULL; node; node = node->next) {
        ir_propagate_into(node);
        if (node->kind == NODE_INSTRUCTION) {
            if (takes_part(node) && (node->results[0] ? node->results[0]->type != IR_STRING : true))
                look_up(k, node);
            continue;
        }
        struct ir_list *const sides[] = {node->body, node->otherwise};
        struct known *outside = k->newest;
        visit_list(k, node->test);
        if (node->kind == NODE_LOOP)
            ir_propagate_into(node);
        for (int i = 0; i < 2; i++) {
            struct known *before = k->newest;
            visit_list(k, sides[i]);
            for (; k->newest != before; k->newest = k->newest->previous)
                k->buckets[k->newest->bucket] = k->newest->below;
        }
        for (; k->newest != outside; k->newest = k->newest->previous)
            k->buckets[k->newest->bucket] = k->newest->below;
    }
}

void pass_common_subexpressions(struct ir_program *ir) {
    struct known_values *k = compilation_get(ir->c, sizeof *k);
    k->ir = ir;
    ir_prepare_propagation(ir);
    visit_list(k, ir->top);
}
