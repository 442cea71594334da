/* SPDX-License-Identifier: Apache-2.0 */
#include "scenes/rib_reader.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

void parameter_list_finish(struct parameter_list *list) {
    primitive_variables_free(list->items, list->count);
    free(list->locations);
    *list = (struct parameter_list){0};
}

const struct primitive_variable *parameter_list_find(const struct parameter_list *list,
                                                     const char *name) {
    for (int i = 0; i < list->count; i++)
        if (strcmp(list->items[i].name, name) == 0)
            return &list->items[i];
    return NULL;
}

/* The declaration of a parameter: inline ("uniform float Kd") or by name; NULL for an undeclared
 * name that is to be skipped. */
static bool parameter_resolve(struct rib_reader *reader, enum parameter_mode mode,
                              const struct rib_token *token, const char **name,
                              const struct declaration **declaration) {
    const char *problem, *text = rib_intern(reader, token->text, token->length);
    struct rib_location location = token->location;
    *declaration = name_table_find(&reader->declarations, text);
    if (!*declaration && strpbrk(text, " \t\n[")) {
        *declaration = rib_parse_declaration(reader, text, true, &problem);
        if (!*declaration)
            return rib_error(reader, &location, "%s: \"%.100s\" is not an inline declaration: %s",
                             reader->request, text, problem);
        /* Kept under the whole text, so that it is parsed once. */
        name_table_set(&reader->declarations, text, (void *)*declaration);
    }
    *name = *declaration && (*declaration)->name ? (*declaration)->name : text;
    if (*declaration)
        return true;
    if (mode == PARAMETERS_STRICT)
        return rib_error(reader, &location,
                         "%s: parameter \"%.100s\" is not declared; declare it: "
                         "Declare \"%.100s\" \"uniform float\"",
                         reader->request, text, text);
    rib_warn(reader, &location, text, "%s: parameter \"%.100s\" is not declared: skipped",
             reader->request, text);
    return true;
}

/* Strings: one, or several in brackets. */
static bool read_strings(struct rib_reader *reader, struct primitive_variable *item) {
    size_t capacity = 0;
    bool is_bracketed = rib_peek(reader)->kind == RIB_TOKEN_OPEN;
    if (is_bracketed)
        rib_take(reader);
    while (rib_peek(reader)->kind == RIB_TOKEN_STRING) {
        const struct rib_token *token = rib_peek(reader);
        item->strings =
            memory_grow(item->strings, &capacity, item->count + 1, sizeof *item->strings);
        item->strings[item->count++] = rib_intern(reader, token->text, token->length);
        rib_take(reader);
        if (!is_bracketed)
            return true;
    }
    const struct rib_token *token = rib_peek(reader);
    if (token->kind == RIB_TOKEN_BAD)
        return rib_error(reader, &token->location, "%s", token->text);
    if (!is_bracketed || token->kind != RIB_TOKEN_CLOSE)
        return rib_error(reader, &token->location, "%s: a string of \"%s\" expected",
                         reader->request, item->name);
    rib_take(reader);
    return true;
}

/* The value of a parameter that nobody wants: an array, a number or a string. */
static bool skip_value(struct rib_reader *reader) {
    const struct rib_token *token = rib_peek(reader);
    bool is_open = token->kind == RIB_TOKEN_OPEN;
    if (is_open) {
        do
            rib_take(reader);
        while (token = rib_peek(reader),
               token->kind == RIB_TOKEN_NUMBER || token->kind == RIB_TOKEN_STRING);
    }
    if (token->kind == RIB_TOKEN_BAD)
        return rib_error(reader, &token->location, "%s", token->text);
    if (is_open ? token->kind != RIB_TOKEN_CLOSE
                : token->kind != RIB_TOKEN_NUMBER && token->kind != RIB_TOKEN_STRING)
        return rib_error(reader, &token->location, "%s: %s expected", reader->request,
                         is_open ? "]" : "a value");
    rib_take(reader);
    return true;
}

static bool read_value(struct rib_reader *reader, struct primitive_variable *item) {
    struct rib_location location = rib_peek(reader)->location;
    if (item->type == RIB_STRING)
        return read_strings(reader, item);
    if (!rib_read_array(reader, item->name, &item->values, &item->count))
        return false;
    for (size_t i = 0; i < item->count; i++)
        if (!(fabs(item->values[i]) <= FLT_MAX))
            return rib_error(reader, &location, "%s: \"%s\": %g is beyond the range of floats",
                             reader->request, item->name, item->values[i]);
    for (size_t i = 0; item->type == RIB_INTEGER && i < item->count; i++)
        if (item->values[i] != floor(item->values[i]))
            return rib_error(reader, &location, "%s: \"%s\" takes integers, not %g",
                             reader->request, item->name, item->values[i]);
    return true;
}

static bool read_parameter(struct rib_reader *reader, enum parameter_mode mode,
                           struct parameter_list *list) {
    const struct rib_token *token = rib_peek(reader);
    struct rib_location location = token->location;
    const struct declaration *declaration;
    const char *name;
    if (!parameter_resolve(reader, mode, token, &name, &declaration))
        return false;
    rib_take(reader);
    if (!declaration)
        return skip_value(reader);
    if (parameter_list_find(list, name))
        return rib_error(reader, &location, "%s: \"%.100s\" is given twice", reader->request, name);
    list->items =
        memory_grow(list->items, &list->capacity, (size_t)list->count + 1, sizeof *list->items);
    list->locations = memory_grow(list->locations, &list->location_capacity,
                                  (size_t)list->count + 1, sizeof *list->locations);
    list->locations[list->count] = location;
    struct primitive_variable *item = &list->items[list->count++];
    *item = (struct primitive_variable){.name = name,
                                        .storage = declaration->storage,
                                        .type = declaration->type,
                                        .array_length = declaration->array_length,
                                        .location = location.at};
    return read_value(reader, item);
}

bool rib_read_parameters(struct rib_reader *reader, enum parameter_mode mode,
                         struct parameter_list *list) {
    *list = (struct parameter_list){0};
    while (rib_peek(reader)->kind == RIB_TOKEN_STRING) {
        if (list->count >= 1000)
            return rib_error(reader, &rib_peek(reader)->location, "%s: more than 1000 parameters",
                             reader->request);
        if (!read_parameter(reader, mode, list))
            return false;
    }
    return true;
}
