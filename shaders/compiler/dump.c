/* SPDX-License-Identifier: Apache-2.0 */
#include "shaders/compiler/passes.h"

#include <inttypes.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

/* The IR as text: a line for an instruction, results first. Variables are printed with the user's
 * name where they have one and their number; ~ marks a varying one. */

struct dump {
    struct ir_program *ir;
    char *text; /* NULL while the length is being counted */
    size_t length;
};

static void put(struct dump *d, const char *format, ...) __attribute__((format(printf, 2, 3)));
static void put(struct dump *d, const char *format, ...) {
    char piece[256];
    va_list arguments;
    va_start(arguments, format);
    int length = vsnprintf(piece, sizeof piece, format, arguments);
    va_end(arguments);
    if (length > (int)sizeof piece - 1)
        length = (int)sizeof piece - 1;
    if (d->text)
        memcpy(d->text + d->length, piece, (size_t)length);
    d->length += (size_t)length;
}

static void put_variable(struct dump *d, const struct ir_variable *variable) {
    put(d, "%s%.40s%s%d", variable->is_varying ? "~" : "", variable->name ? variable->name : "",
        variable->name ? "." : "t", variable->id);
}

static void put_operand(struct dump *d, const struct ir_operand *operand) {
    char name[32];
    switch (operand->kind) {
    case OPERAND_VARIABLE:
        put_variable(d, operand->variable);
        break;
    case OPERAND_FLOAT:
        put(d, "%.9g", (double)operand->number);
        break;
    case OPERAND_BOOL:
        put(d, operand->truth ? "true" : "false");
        break;
    case OPERAND_STRING:
        put(d, "string:%d", (int)operand->identity);
        break;
    case OPERAND_FIXED:
        put(d, "%" PRId64 ":%s", operand->raw, fixed_format_name(operand->format, name));
        break;
    case OPERAND_NONE:
        break;
    }
}

static void put_declarations(struct dump *d, const struct ir_list *list, int indent) {
    static const char *const types[] = {"float", "condition", "string", ""};
    char name[32];
    for (const struct ir_variable *v = list->variables; v; v = v->next_in_home) {
        put(d, "%*s%s %s ", indent, "", v->is_varying ? "varying" : "uniform",
            v->type == IR_FIXED ? fixed_format_name(v->format, name) : types[v->type]);
        put_variable(d, v);
        if (v->array_length)
            put(d, "[%d]", v->array_length);
        put(d, "\n");
    }
}

static void put_instruction(struct dump *d, const struct ir_node *node, int indent) {
    const struct ir_operation_info *info = &ir_operations[node->operation];
    put(d, "%*s", indent, "");
    for (int i = 0; i < 3; i++) {
        if (!node->results[i])
            continue;
        put_variable(d, node->results[i]);
        put(d, i < 2 && node->results[i + 1] ? ", " : " = ");
    }
    put(d, "%s%s", info->name, node->is_fast ? "_FAST" : "");
    if (node->array) {
        put(d, " ");
        put_variable(d, node->array);
    }
    for (int i = 0; i < ir_operand_count(node->operation); i++) {
        put(d, i ? ", " : " ");
        put_operand(d, &node->operands[i]);
    }
    if (node->external)
        put(d, " %.64s()", node->external->name);
    if (node->parameter)
        put(d, " %.64s[%d]", node->parameter->name, node->index);
    if (node->at && node->at->line)
        put(d, "    // %d", node->at->line);
    put(d, "\n");
}

static void put_list(struct dump *d, const struct ir_list *list, int indent);

static void put_control(struct dump *d, const struct ir_node *node, int indent) {
    const char *varying = node->is_varying ? "varying " : "";
    if (node->kind == NODE_LOOP) {
        put(d, "%*s%sloop\n", indent, "", varying);
        put_list(d, node->test, indent + 4);
        put(d, "%*swhile ", indent, "");
        put_operand(d, &node->condition);
        put(d, "\n");
    } else if (node->kind == NODE_IF) {
        put(d, "%*s%sif ", indent, "", varying);
        put_operand(d, &node->condition);
        put(d, "\n");
    } else {
        put(d, "%*silluminance\n", indent, "");
    }
    put_list(d, node->body, indent + 4);
    if (node->otherwise) {
        put(d, "%*selse\n", indent, "");
        put_list(d, node->otherwise, indent + 4);
    }
}

static void put_list(struct dump *d, const struct ir_list *list, int indent) {
    put_declarations(d, list, indent);
    for (const struct ir_node *node = list->first; node; node = node->next) {
        if (node->kind == NODE_INSTRUCTION)
            put_instruction(d, node, indent);
        else
            put_control(d, node, indent);
    }
}

char *ir_dump(struct ir_program *ir) {
    struct dump dump = {.ir = ir};
    put_list(&dump, ir->top, 0);
    dump.text = arena_get(&ir->c->program->arena, dump.length + 1);
    if (!dump.text)
        compile_limit(ir->c, NULL, "the dump needs more memory than the compiler may use");
    dump.length = 0;
    put_list(&dump, ir->top, 0);
    return dump.text;
}
