/* SPDX-License-Identifier: Apache-2.0 */
#include "shaders/compiler/emit.h"

/* Modules that note what values their variables have, and can round them as fixed-point numbers
 * would be (shader_module.h). Only floats have probes; they are looked at where they are assigned.
 */

static const char *const support[] = {
    "SHADER_HELPER void shader_note(struct shader_probe *probe, float value) {\n"
    "    if (!(value - value == 0.0f)) {\n        probe->unusable++;\n        return;\n    }\n"
    "    if (!probe->count || value < probe->lowest)\n        probe->lowest = value;\n"
    "    if (!probe->count || value > probe->highest)\n        probe->highest = value;\n"
    "    probe->count++;\n}\n\n",
    "SHADER_HELPER float shader_probe_one(struct shader_probe *probe, float value) {\n"
    "    shader_note(probe, value);\n"
    "    return value;\n}\n\n",
    "SHADER_HELPER vf shader_probe_lanes(struct shader_probe *probe, vf value, vi mask) {\n"
    "    for (int i = 0; i < SHADER_WIDTH; i++)\n"
    "        if (mask[i])\n            shader_note(probe, value[i]);\n"
    "    if (probe->scale != 0.0f)\n"
    "        value = vf_floor(value * probe->scale) / probe->scale;\n"
    "    return value;\n}\n\n",
    "SHADER_HELPER vi shader_valid_lanes(size_t first, size_t count) {\n"
    "    vi mask = {0};\n"
    "    for (int i = 0; i < SHADER_WIDTH; i++)\n"
    "        mask[i] = first + (size_t)i < count ? -1 : 0;\n"
    "    return mask;\n}\n\n",
};

static bool has_probes(const struct emitter *e) {
    return e->c->options && e->c->options->has_probes;
}

void emit_probe_support(struct emitter *e) {
    if (!has_probes(e))
        return;
    emit_text(e, "static struct shader_probe shader_probes[%d];\n\n",
              (int)e->ir->variable_count + 1);
    for (size_t i = 0; i < sizeof support / sizeof *support; i++)
        emit_support_text(e, support[i]);
}

void emit_probe_lanes(struct emitter *e) {
    if (has_probes(e))
        emit_line(e, e->in_light ? "const vi valid SHADER_UNUSED = vi_set(-1);"
                                 : "const vi valid SHADER_UNUSED = shader_valid_lanes(at, "
                                   "call->count);");
}

void emit_probes(struct emitter *e, const struct ir_node *node) {
    for (int r = 0; has_probes(e) && r < 3; r++) {
        const struct ir_variable *v = node->results[r];
        if (!v || v->type != IR_FLOAT)
            continue;
        if (!v->is_varying)
            emit_line(e, "v%d = shader_probe_one(&shader_probes[%d], v%d);", v->id, v->id, v->id);
        else if (e->mask >= 0)
            emit_line(e, "v%d = shader_probe_lanes(&shader_probes[%d], v%d, valid & m%d);", v->id,
                      v->id, v->id, e->mask);
        else
            emit_line(e, "v%d = shader_probe_lanes(&shader_probes[%d], v%d, valid);", v->id, v->id,
                      v->id);
    }
}

void emit_probe_fields(struct emitter *e) {
    if (has_probes(e))
        emit_text(e, "    .probe_count = %d,\n    .probes = shader_probes,\n",
                  (int)e->ir->variable_count);
}
