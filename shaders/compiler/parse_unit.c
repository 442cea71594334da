/* SPDX-License-Identifier: Apache-2.0 */
#include "shaders/compiler/parser.h"

#include <string.h>

/* A whole file: functions and a shader. */

static bool parse_shader_kind(struct parser *p, enum shader_kind *kind) {
    static const struct {
        int token;
        enum shader_kind kind;
    } kinds[] = {
        {TOKEN_SURFACE, SHADER_KIND_SURFACE},
        {TOKEN_LIGHT, SHADER_KIND_LIGHT},
        {TOKEN_DISPLACEMENT, SHADER_KIND_DISPLACEMENT},
        {TOKEN_VOLUME, SHADER_KIND_VOLUME},
        {TOKEN_IMAGER, SHADER_KIND_IMAGER},
    };
    for (size_t i = 0; i < sizeof kinds / sizeof *kinds; i++)
        if (kinds[i].token == p->token.kind) {
            *kind = kinds[i].kind;
            return true;
        }
    if (p->token.kind == TOKEN_TRANSFORMATION) {
        compile_error(p->c, &p->token.at,
                      "transformation shaders are not supported: geometry is transformed by the "
                      "scene, before any shader runs");
        compilation_stop(p->c);
    }
    return false;
}

/* The name of a file without folders and ending. */
static bool is_named_like_file(const char *name, const char *file) {
    const char *slash = strrchr(file, '/'), *base = slash ? slash + 1 : file;
    size_t length = strcspn(base, ".");
    return strlen(name) == length && !memcmp(name, base, length);
}

/* Of several shaders in a file the one that is named like it counts, else the first. */
static void add_shader(struct parser *p, struct ast_unit *unit, struct ast_function *shader,
                       enum shader_kind kind) {
    bool is_second = unit->shader != NULL;
    if (!is_second || (!is_named_like_file(unit->shader->name, p->file) &&
                       is_named_like_file(shader->name, p->file))) {
        unit->shader = shader;
        unit->kind = kind;
    }
    if (is_second)
        compile_warning(p->c, &shader->at, "more than one shader in this file: %.64s is used",
                        unit->shader->name);
}

/* 'extern' "C" [type] name formals ';': a function of the object that the command line names */
static struct ast_function *parse_external(struct parser *p) {
    const struct source_location at = p->token.at;
    struct declaration d = {TYPE_FLOAT, STORAGE_UNSAID, false, false};
    if (strcmp(p->ahead.text, "C"))
        parser_complain(p, &p->ahead.at, "functions from outside are extern \"C\"");
    parser_advance(p);
    parser_advance(p);
    if (p->token.kind != TOKEN_IDENTIFIER || p->ahead.kind != '(')
        parse_declaration_type(p, &d);
    if (p->is_panicking || p->ahead.kind != '(') {
        parser_complain(p, &p->token.at, "expected a function after extern \"C\"");
        return NULL;
    }
    struct ast_function *function = parse_function(p, d.type, false);
    function->is_external = true;
    if (!function->is_prototype && !p->is_panicking)
        parser_complain(p, &function->at,
                        "a function that is extern \"C\" has no body: it comes from an object");
    if (!p->c->options || !p->c->options->allows_external)
        parser_complain(p, &at,
                        "this shader calls functions of an object of yours, which the command line "
                        "must allow: --link FILE.so");
    return function;
}

/* [type] name formals body, extern "C" and a function, or a stray ';' */
static void parse_unit_function(struct parser *p, struct ast_function ***link, bool is_prelude) {
    struct declaration d = {TYPE_FLOAT, STORAGE_UNSAID, false, false};
    if (parser_accept(p, ';'))
        return;
    if (p->token.kind == TOKEN_EXTERN && p->ahead.kind == TOKEN_STRING) {
        struct ast_function *external = parse_external(p);
        if (external) {
            **link = external;
            *link = &external->next;
        }
        return;
    }
    if (p->token.kind != TOKEN_IDENTIFIER || p->ahead.kind != '(')
        parse_declaration_type(p, &d); /* RSL: else the result is a float */
    if (p->is_panicking || p->ahead.kind != '(') {
        parser_complain(p, &p->token.at, "expected a function or a shader");
        return;
    }
    struct ast_function *function = parse_function(p, d.type, false);
    function->is_prelude = is_prelude;
    if (function->is_prototype)
        return;
    **link = function;
    *link = &function->next;
}

/* {function} (kind name formals body) {functions} */
struct ast_unit *parse_unit(struct compilation *c, const char *file, const char *text,
                            size_t length, bool is_prelude) {
    struct parser parser = {.c = c, .file = file}, *p = &parser;
    struct ast_unit *unit = compilation_get(c, sizeof *unit);
    struct ast_function **link = &unit->functions;
    preprocess_start(&p->source, c, file, text, length);
    for (int i = 0; i < 3; i++)
        parser_advance(p);
    while (p->token.kind != TOKEN_END) {
        enum shader_kind kind;
        if (parse_shader_kind(p, &kind)) {
            parser_advance(p);
            add_shader(p, unit, parse_function(p, TYPE_VOID, true), kind);
        } else {
            parse_unit_function(p, &link, is_prelude);
        }
        if (p->is_panicking) {
            parser_recover(p);
            parser_accept(p, '}');
        }
    }
    if (!unit->shader && !is_prelude && !c->error_count)
        compile_error(c, &p->token.at, "there is no shader in this file");
    return unit;
}
