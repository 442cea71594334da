/* SPDX-License-Identifier: Apache-2.0 */
#include "nodes/chunker.h"

#include "nodes/slot_formats.h"
#include "nodes/vertex_components.h"

#include <stdlib.h>
#include <string.h>

struct chunk_builder {
    const struct scene_mesh *mesh;
    struct vertex_components components;
    uint32_t *local; /* vertex of the mesh -> vertex of the chunk, valid when stamp matches */
    uint32_t *stamp; /* number of the chunk (plus 1) that last used the vertex */
    float *positions;
    float *material;
    uint16_t *triangles;
    struct chunk_payload chunk;
    struct chunk_list *list;
    const struct chunk_cutting *cutting;
    uint32_t run;                   /* number of the first chunk of the run at hand */
    struct record_sharing *sharing; /* of the chunk at hand with others of the run */
    size_t sharing_count, sharing_capacity;
};

static void flush_chunk(struct chunk_builder *builder) {
    struct chunk_payload *chunk = &builder->chunk;
    if (!chunk->triangle_count)
        return;
    struct chunk_list *list = builder->list;
    chunk->number = (uint32_t)list->count;
    chunk->positions = builder->positions;
    chunk->material = builder->material;
    chunk->triangles = builder->triangles;
    list->messages =
        memory_grow(list->messages, &list->capacity, list->count + 1, sizeof *list->messages);
    list->messages[list->count++] = chunk_payload_encode(chunk, builder->cutting->frame_index);
    if (list->is_recorded)
        record_add_chunk(&list->recorded,
                         (struct record_chunk){.instance = chunk->shader_id,
                                               .vertices = chunk->vertex_count,
                                               .triangles = chunk->triangle_count,
                                               .begins_run = chunk->number == builder->run},
                         builder->sharing, (uint32_t)builder->sharing_count);
    builder->sharing_count = 0;
    chunk->vertex_count = chunk->triangle_count = 0;
}

/* What follows is separate from what was before. */
static void end_run(struct chunk_builder *builder) {
    flush_chunk(builder);
    builder->run = (uint32_t)builder->list->count;
}

/* The vertex was last in the chunk so far before the one at hand. */
static void note_sharing(struct chunk_builder *builder, uint32_t distance) {
    size_t i = 0;
    while (i < builder->sharing_count && builder->sharing[i].distance != distance)
        i++;
    if (i == builder->sharing_count) {
        builder->sharing = memory_grow(builder->sharing, &builder->sharing_capacity,
                                       ++builder->sharing_count, sizeof *builder->sharing);
        builder->sharing[i] = (struct record_sharing){distance, 0};
    }
    builder->sharing[i].vertices++;
}

static uint16_t chunk_vertex(struct chunk_builder *builder, uint32_t vertex) {
    struct chunk_payload *chunk = &builder->chunk;
    const uint32_t stamp = (uint32_t)builder->list->count + 1;
    if (builder->stamp[vertex] != stamp) {
        if (builder->list->is_recorded && builder->stamp[vertex] > builder->run)
            note_sharing(builder, stamp - builder->stamp[vertex]);
        builder->stamp[vertex] = stamp;
        builder->local[vertex] = chunk->vertex_count;
        memcpy(builder->positions + chunk->vertex_count * 3,
               builder->mesh->positions + (size_t)vertex * 3, 3 * sizeof(float));
        float *material =
            builder->material + (size_t)chunk->vertex_count * builder->components.count;
        for (uint32_t c = 0; c < builder->components.count; c++)
            material[c] =
                builder->components.list[c].values[vertex * builder->components.list[c].stride];
        chunk->vertex_count++;
    }
    return (uint16_t)builder->local[vertex];
}

/* Seen from the eye, does the outside (Ng of its first vertex) face away? */
static bool faces_away(const struct scene_mesh *mesh, const struct scene_variable *outside,
                       const uint32_t *corner, bool is_perspective) {
    const float *n = outside->values + (size_t)corner[0] * 3,
                *p = mesh->positions + (size_t)corner[0] * 3;
    return is_perspective ? (double)n[0] * p[0] + (double)n[1] * p[1] + (double)n[2] * p[2] >= 0
                          : n[2] >= 0;
}

static void cut_mesh(struct chunk_builder *builder, const struct shader_program *program,
                     uint32_t first_primitive, bool is_perspective) {
    const struct scene_mesh *mesh = builder->mesh;
    const struct scene_variable *outside =
        mesh->is_two_sided ? NULL : scene_mesh_variable(mesh, "Ng");
    vertex_components_list(mesh, program, &builder->components);
    builder->chunk.material_count = builder->components.count;
    builder->chunk.map_bytes = (uint32_t)program->material_bytes;
    builder->local = memory_get(mesh->vertex_count, sizeof *builder->local);
    builder->stamp = memory_get(mesh->vertex_count, sizeof *builder->stamp);
    const size_t vertices = 3 * (size_t)(mesh->triangle_count < builder->cutting->triangles
                                             ? mesh->triangle_count
                                             : builder->cutting->triangles);
    builder->positions = memory_get(3 * vertices, sizeof *builder->positions);
    builder->triangles = memory_get(vertices, sizeof *builder->triangles);
    builder->material = memory_get(vertices * builder->components.count, sizeof *builder->material);
    for (uint32_t t = 0; t < mesh->triangle_count; t++) {
        const uint32_t *corner = mesh->triangles + (size_t)t * 3;
        if (outside && faces_away(mesh, outside, corner, is_perspective)) {
            end_run(builder); /* a chunk's primitive numbers have no gaps */
            continue;
        }
        struct chunk_payload *chunk = &builder->chunk;
        if (!chunk->triangle_count)
            chunk->first_primitive = first_primitive + t;
        for (int i = 0; i < 3; i++)
            builder->triangles[chunk->triangle_count * 3 + i] = chunk_vertex(builder, corner[i]);
        if (++chunk->triangle_count == builder->cutting->triangles)
            flush_chunk(builder);
    }
    end_run(builder);
    vertex_components_finish(&builder->components);
    free(builder->local);
    free(builder->stamp);
    free(builder->material);
    free(builder->positions);
    free(builder->triangles);
}

void chunk_list_finish(struct chunk_list *list) {
    free(list->messages);
    record_frame_finish(&list->recorded);
    *list = (struct chunk_list){0};
}

bool chunker_cut(const struct scene_frame *frame, const struct frame_plan *plan,
                 const struct chunk_cutting *cutting, struct chunk_list *list,
                 struct status *status) {
    struct chunk_builder *builder = memory_get(1, sizeof *builder);
    struct slot_formats formats;
    slot_formats_choose(frame, plan, cutting->precision, &formats);
    builder->cutting = cutting;
    builder->list = list;
    uint64_t primitives = 0;
    bool ok = true;
    for (size_t m = 0; ok && m < frame->mesh_count; m++) {
        builder->mesh = &frame->meshes[m];
        builder->chunk.shader_id = plan->mesh_instance[m];
        builder->chunk.formats = formats.instances[plan->mesh_instance[m] - 1];
        if (primitives + builder->mesh->triangle_count >= UINT32_MAX)
            ok = status_fail(status, STATUS_LIMIT, "more than 2^32 - 1 triangles in one frame");
        else
            cut_mesh(builder, plan->instances[plan->mesh_instance[m] - 1].variant->program,
                     (uint32_t)primitives, frame->camera.is_perspective);
        primitives += builder->mesh->triangle_count;
    }
    slot_formats_finish(&formats);
    free(builder->sharing);
    free(builder);
    return ok;
}
