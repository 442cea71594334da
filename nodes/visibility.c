/* SPDX-License-Identifier: Apache-2.0 */
#include "nodes/visibility.h"

#include "base/vector.h"
#include "nodes/slot_formats.h"
#include "nodes/triangle_setup.h"
#include "nodes/visibility_kernels.h"

#include <embree3/rtcore.h>
#include <float.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Embree decides which triangles a ray may meet; whether the sample lies inside, how deep, and
 * which of them wins is ours (triangle_setup.h), from triangle and sample alone, with ties to the
 * lower primitive number.
 *
 * Embree's own distance is used for one thing: to skip what is farther than the best hit so far. So
 * that nothing near the best is skipped, rays are kept alive VISIBILITY_MARGIN beyond it. The
 * distance to a triangle seen nearly edge-on is too uncertain even for that: such triangles are
 * cast against in a scene of their own in which nothing is skipped. */
#define VISIBILITY_MARGIN (1.0f / 256)

/* How uncertain Embree's distance may be, relative to the depth, as a multiple of the float
 * rounding error: 2^-24 of this times a factor of 64 for its arithmetic stays within half the
 * margin. */
#define VISIBILITY_CONDITION_MAX 512.0

/* Embree refuses coordinates beyond some 2^60, and its products of tiny ones vanish: triangles
 * whose largest coordinate is outside these powers of two are cast against in scenes of their own,
 * scaled about the eye by a power of two. */
#define VISIBILITY_EXPONENT_MIN (-30)
#define VISIBILITY_EXPONENT_MAX 58

struct visibility_device {
    RTCDevice device;
};

struct triangle_source {
    uint32_t chunk, triangle; /* within the chunk */
};

/* A stretch of covered samples in one row that see the same triangle. */
struct span {
    uint32_t triangle, sample, count;
};

/* Triangles whose distance is certain enough to skip by, those seen nearly edge-on, and those that
 * need another scale. */
enum { SCENE_SKIPPING, SCENE_CAREFUL, SCENE_HUGE, SCENE_TINY, SCENE_COUNT };

struct visibility {
    struct frame_payload frame;
    const struct visibility_kernels *kernels;
    struct region_bins bins;
    struct region_bins rare_bins; /* of triangles of all scenes but the first */
    const struct chunk_payload *chunks;
    size_t triangle_count;
    struct triangle_setup *setups;
    struct sample_box *boxes;
    struct triangle_source *sources;
    uint32_t *primitives; /* primitive numbers */
    struct traced_scene {
        RTCScene scene;      /* NULL: no triangles */
        uint32_t *triangles; /* Embree's number -> ours */
        uint32_t count;
        float scale; /* Embree's coordinates over ours: a power of two */
    } scenes[SCENE_COUNT];
    /* scratch for one region, by sample index */
    float *depth;
    uint32_t *triangle;    /* UINT32_MAX: nothing there */
    float *barycentric[3]; /* of one span */
    struct span *spans;
    uint32_t span_count;
    float *screen_x, *screen_y;
    uint32_t origin_x, origin_y; /* its first sample in the picture */
    uint32_t nan_depths, rays;
    struct packet *packet; /* at hand */
};

/* One packet of rays, as the filter sees it. */
struct packet {
    struct RTCIntersectContext context; /* first: Embree hands it to the filter */
    struct visibility *visibility;
    const struct traced_scene *scene;
    struct packet_lanes lanes;
    struct RTCRayHit16 rays;
    _Alignas(64) int valid[PACKET_LANES]; /* which of them are in the picture */
};

bool visibility_device_create(struct visibility_device **device, struct status *status) {
    *device = memory_get(1, sizeof **device);
    (*device)->device = rtcNewDevice("threads=1,set_affinity=0");
    if ((*device)->device)
        return true;
    free(*device);
    *device = NULL;
    return status_fail(status, STATUS_INTERNAL, "Embree gave no device (error %d)",
                       (int)rtcGetDeviceError(NULL));
}

void visibility_device_destroy(struct visibility_device *device) {
    if (!device)
        return;
    rtcReleaseDevice(device->device);
    free(device);
}

static struct packet_triangle candidate_of(const struct packet *packet, uint32_t hit) {
    const struct visibility *visibility = packet->visibility;
    const uint32_t triangle = packet->scene->triangles[hit];
    return (struct packet_triangle){&visibility->setups[triangle],
                                    visibility->boxes[triangle],
                                    triangle,
                                    visibility->primitives[triangle],
                                    visibility->frame.near_plane,
                                    visibility->frame.far_plane};
}

/* What Embree tells of hits: `count` of them as structure of arrays (the C API has no accessors for
 * it), of lanes `id` of the packet. */
struct hits {
    unsigned count;
    int *valid;
    float *tfar;
    const uint32_t *id, *triangle;
};

/* Hits `mine` (a bit each) of one triangle. */
static void consider(struct packet *packet, const struct hits *hits, uint32_t mine,
                     uint32_t triangle) {
    struct visibility *visibility = packet->visibility;
    const struct packet_triangle candidate = candidate_of(packet, triangle);
    const bool skips = packet->scene == &visibility->scenes[SCENE_SKIPPING];
    _Alignas(64) int32_t valid[PACKET_LANES] = {0};
    for (uint32_t left = mine; left; left &= left - 1)
        valid[hits->id[__builtin_ctz(left)]] = -1;
    visibility->nan_depths += visibility->kernels->consider(&packet->lanes, &candidate, valid);
    for (uint32_t left = mine; left; left &= left - 1) {
        const int i = __builtin_ctz(left);
        const float best = packet->lanes.depth[hits->id[i]];
        if (skips && valid[hits->id[i]])
            hits->tfar[i] = best + fabsf(best) * VISIBILITY_MARGIN;
        else
            hits->valid[i] = 0; /* as if missed: the ray goes on as far as it would have */
    }
}

/* Called for every hit Embree finds, for as many rays at once as it likes. */
static void consider_hit(const struct RTCFilterFunctionNArguments *arguments) {
    enum { RAY_TFAR = 8, RAY_ID = 10, HIT_PRIMITIVE = 5 };
    const unsigned count = arguments->N;
    const struct hits hits = {count, arguments->valid, (float *)arguments->ray + RAY_TFAR * count,
                              (const uint32_t *)arguments->ray + RAY_ID * count,
                              (const uint32_t *)arguments->hit + HIT_PRIMITIVE * count};
    uint32_t waiting = 0; /* a bit for each hit */
    for (unsigned i = 0; i < count; i++)
        waiting |= (uint32_t)(hits.valid[i] != 0) << i;
    while (waiting) { /* once, unless there are several triangles */
        const uint32_t triangle = hits.triangle[__builtin_ctz(waiting)];
        uint32_t mine = 0;
        for (unsigned i = 0; i < count; i++)
            mine |= (uint32_t)(hits.triangle[i] == triangle) << i;
        mine &= waiting;
        consider((struct packet *)arguments->context, &hits, mine, triangle);
        waiting &= ~mine;
    }
}

/* An Embree scene of the triangles listed in `traced`; `corners` holds the vertex numbers of all.
 */
static bool build_scene(struct traced_scene *traced, RTCDevice device, const float *vertices,
                        size_t vertex_count, const uint32_t *corners, struct status *status) {
    if (!traced->count)
        return true;
    traced->scene = rtcNewScene(device);
    rtcSetSceneFlags(traced->scene, RTC_SCENE_FLAG_ROBUST);
    RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE);
    float *v = rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3,
                                       3 * sizeof(float), vertex_count);
    uint32_t *t = rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3,
                                          3 * sizeof(uint32_t), traced->count);
    if (v && t) {
        for (size_t i = 0; i < 3 * vertex_count; i++)
            v[i] = vertices[i] * traced->scale;
        for (uint32_t i = 0; i < traced->count; i++)
            memcpy(t + 3 * (size_t)i, corners + 3 * (size_t)traced->triangles[i],
                   3 * sizeof(uint32_t));
        rtcSetGeometryIntersectFilterFunction(geometry, consider_hit);
        rtcCommitGeometry(geometry);
        rtcAttachGeometry(traced->scene, geometry);
    }
    rtcReleaseGeometry(geometry);
    rtcCommitScene(traced->scene);
    enum RTCError error = rtcGetDeviceError(device);
    if (!v || !t || error != RTC_ERROR_NONE)
        return status_fail(status, STATUS_LIMIT,
                           "Embree could not build a scene of %u triangles (error %d)",
                           traced->count, (int)error);
    return true;
}

/* By how much Embree's rounding errors grow in the distance to a triangle, relative to its depth:
 * the size of its coordinates against the distance of its plane from the eye (perspective), or
 * against its least depth at the slope it is seen at (orthographic). */
static double distance_condition(const float *v0, const float *v1, const float *v2,
                                 bool is_perspective) {
    const struct vec3 a = {v0[0], v0[1], v0[2]}, b = {v1[0], v1[1], v1[2]},
                      c = {v2[0], v2[1], v2[2]};
    const struct vec3 normal = vec3_cross(vec3_subtract(b, a), vec3_subtract(c, a));
    const double size = sqrt(fmax(vec3_dot(a, a), fmax(vec3_dot(b, b), vec3_dot(c, c))));
    const double length = sqrt(vec3_dot(normal, normal));
    const double certain = is_perspective
                               ? fabs(vec3_dot(normal, a))
                               : fabs(normal.z) * fmin(fabs(a.z), fmin(fabs(b.z), fabs(c.z)));
    return size * length / certain; /* infinite or not a number when seen on edge */
}

/* The exponent of the largest coordinate of a triangle. */
static int largest_exponent(const float *const v[3]) {
    float largest = 0;
    for (int i = 0; i < 3; i++)
        for (int axis = 0; axis < 3; axis++)
            largest = fmaxf(largest, fabsf(v[i][axis]));
    return largest > 0 ? ilogbf(largest) : 0;
}

static int choose_scene(const float *const v[3], bool is_perspective) {
    const int exponent = largest_exponent(v);
    if (exponent > VISIBILITY_EXPONENT_MAX)
        return SCENE_HUGE;
    if (exponent < VISIBILITY_EXPONENT_MIN)
        return SCENE_TINY;
    return distance_condition(v[0], v[1], v[2], is_perspective) < VISIBILITY_CONDITION_MAX
               ? SCENE_SKIPPING
               : SCENE_CAREFUL;
}

/* Collects the triangles that can be seen: set up, binned, and given to Embree under their index
 * here. */
static size_t collect_triangles(struct visibility *visibility, size_t chunk_count, float *vertices,
                                uint32_t *indices) {
    size_t vertex_count = 0, count = 0;
    for (size_t c = 0; c < chunk_count; c++) {
        const struct chunk_payload *chunk = &visibility->chunks[c];
        if (chunk->vertex_count)
            memcpy(vertices + vertex_count * 3, chunk->positions,
                   chunk->vertex_count * 3 * sizeof(float));
        for (uint32_t t = 0; t < chunk->triangle_count; t++) {
            const uint16_t *corner = chunk->triangles + 3 * t;
            const float *v[3];
            for (int i = 0; i < 3; i++)
                v[i] = chunk->positions + 3 * corner[i];
            if (!triangle_setup_make(v[0], v[1], v[2], visibility->frame.is_perspective,
                                     &visibility->setups[count]))
                continue;
            const int number = choose_scene(v, visibility->frame.is_perspective);
            struct traced_scene *traced = &visibility->scenes[number];
            traced->triangles[traced->count++] = (uint32_t)count;
            visibility->sources[count] = (struct triangle_source){(uint32_t)c, t};
            visibility->primitives[count] = chunk->first_primitive + t;
            for (int i = 0; i < 3; i++)
                indices[count * 3 + i] = (uint32_t)vertex_count + corner[i];
            const struct binned_triangle binned = {
                {v[0], v[1], v[2]}, &visibility->setups[count], chunk->number, chunk->map_bytes};
            visibility->boxes[count] =
                region_bins_add(&visibility->bins, &visibility->frame, &binned);
            if (number != SCENE_SKIPPING)
                region_bins_add(&visibility->rare_bins, &visibility->frame, &binned);
            count++;
        }
        vertex_count += chunk->vertex_count;
    }
    visibility->triangle_count = count;
    return vertex_count;
}

/* A packet with all that is the same for every tile; the rays of an orthographic view go along z,
 * all others come from the eye. */
static struct packet *packet_create(struct visibility *visibility) {
    struct packet *packet = aligned_alloc(64, (sizeof *packet + 63) / 64 * 64);
    if (!packet)
        abort();
    memset(packet, 0, sizeof *packet);
    packet->visibility = visibility;
    for (unsigned lane = 0; lane < PACKET_LANES; lane++) {
        packet->rays.ray.dir_z[lane] = 1;
        packet->rays.ray.mask[lane] = UINT32_MAX;
        packet->rays.ray.id[lane] = lane;
    }
    return packet;
}

static void create_scratch(struct visibility *visibility) {
    const struct region_grid *grid = &visibility->bins.grid;
    const size_t samples = (size_t)grid->region_width * grid->region_height;
    visibility->depth = memory_get(samples, sizeof(float));
    visibility->triangle = memory_get(samples, sizeof(uint32_t));
    visibility->spans = memory_get(samples, sizeof *visibility->spans);
    for (int i = 0; i < 3; i++)
        visibility->barycentric[i] = memory_get(grid->region_width, sizeof(float));
    visibility->screen_x = memory_get(grid->region_width, sizeof(float));
    visibility->screen_y = memory_get(grid->region_height, sizeof(float));
    visibility->packet = packet_create(visibility);
}

bool visibility_create(struct visibility_device *device, const struct frame_payload *frame,
                       const struct region_grid *grid, const struct chunk_payload *chunks,
                       size_t chunk_count, bool records_work, struct visibility **out,
                       struct status *status) {
    struct visibility *visibility = memory_get(1, sizeof *visibility);
    visibility->frame = *frame;
    visibility->kernels = visibility_kernels_best();
    visibility->chunks = chunks;
    region_bins_init(&visibility->bins, grid, records_work);
    region_bins_init(&visibility->rare_bins, grid, false);
    size_t vertices = 0, triangles = 0;
    for (size_t c = 0; c < chunk_count; c++) {
        vertices += chunks[c].vertex_count;
        triangles += chunks[c].triangle_count;
    }
    bool ok = true;
    if (triangles) {
        visibility->setups = memory_get(triangles, sizeof *visibility->setups);
        visibility->boxes = memory_get(triangles, sizeof *visibility->boxes);
        visibility->sources = memory_get(triangles, sizeof *visibility->sources);
        visibility->primitives = memory_get(triangles, sizeof *visibility->primitives);
        for (int i = 0; i < SCENE_COUNT; i++) {
            visibility->scenes[i].triangles = memory_get(triangles, sizeof(uint32_t));
            visibility->scenes[i].scale = 1;
        }
        visibility->scenes[SCENE_HUGE].scale = ldexpf(1, VISIBILITY_EXPONENT_MAX - 127);
        visibility->scenes[SCENE_TINY].scale = ldexpf(1, 100);
        float *positions = memory_get(vertices * 3, sizeof *positions);
        uint32_t *indices = memory_get(triangles * 3, sizeof *indices);
        collect_triangles(visibility, chunk_count, positions, indices);
        if (visibility->triangle_count) {
            for (int i = 0; ok && i < SCENE_COUNT; i++)
                ok = build_scene(&visibility->scenes[i], device->device, positions, vertices,
                                 indices, status);
            create_scratch(visibility);
        }
        free(positions);
        free(indices);
    }
    if (!ok) {
        visibility_destroy(visibility);
        return false;
    }
    *out = visibility;
    return true;
}

void visibility_destroy(struct visibility *visibility) {
    if (!visibility)
        return;
    for (int i = 0; i < SCENE_COUNT; i++) {
        if (visibility->scenes[i].scene)
            rtcReleaseScene(visibility->scenes[i].scene);
        free(visibility->scenes[i].triangles);
    }
    region_bins_finish(&visibility->bins);
    region_bins_finish(&visibility->rare_bins);
    free(visibility->setups);
    free(visibility->boxes);
    free(visibility->sources);
    free(visibility->primitives);
    free(visibility->depth);
    free(visibility->triangle);
    free(visibility->spans);
    for (int i = 0; i < 3; i++)
        free(visibility->barycentric[i]);
    free(visibility->screen_x);
    free(visibility->screen_y);
    free(visibility->packet);
    free(visibility);
}

const struct region_bins *visibility_bins(const struct visibility *visibility) {
    return &visibility->bins;
}

/* Points the packet at the tile whose first sample is (x0, y0) in the region, `wide` by `high` of
 * its samples inside the picture. */
static void aim_packet(struct packet *packet, uint32_t x0, uint32_t y0, uint32_t wide,
                       uint32_t high) {
    const struct visibility *visibility = packet->visibility;
    struct packet_lanes *lanes = &packet->lanes;
    for (unsigned dy = 0; dy < TILE_SAMPLES; dy++)
        for (unsigned dx = 0; dx < TILE_SAMPLES; dx++) {
            const unsigned lane = dy * TILE_SAMPLES + dx;
            const double x = visibility->screen_x[x0 + (dx < wide ? dx : 0)],
                         y = visibility->screen_y[y0 + (dy < high ? dy : 0)];
            packet->valid[lane] = dx < wide && dy < high ? -1 : 0;
            lanes->x[lane] = x;
            lanes->y[lane] = y;
            lanes->tolerance[lane] = triangle_setup_tolerance(x, y);
            lanes->column[lane] = visibility->origin_x + x0 + dx;
            lanes->row[lane] = visibility->origin_y + y0 + dy;
            lanes->depth[lane] = INFINITY;
        }
}

/* Casts the packet against one scene. */
static void cast_packet(struct packet *packet, const struct traced_scene *scene) {
    struct RTCRayHit16 *rays = &packet->rays;
    packet->scene = scene;
    rtcInitIntersectContext(&packet->context);
    packet->context.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
    const bool is_perspective = packet->visibility->frame.is_perspective;
    float *x = is_perspective ? rays->ray.dir_x : rays->ray.org_x,
          *y = is_perspective ? rays->ray.dir_y : rays->ray.org_y;
    const float scale = is_perspective ? 1 : scene->scale;
    for (unsigned lane = 0; lane < PACKET_LANES; lane++) {
        x[lane] = (float)packet->lanes.x[lane] * scale;
        y[lane] = (float)packet->lanes.y[lane] * scale;
        rays->ray.tfar[lane] = INFINITY;
        rays->hit.geomID[lane] = rays->hit.instID[0][lane] = RTC_INVALID_GEOMETRY_ID;
    }
    rtcIntersect16(packet->valid, scene->scene, &packet->context, rays);
}

/* Casts the rays of one tile against the first `scene_count` scenes. */
static void cast_tile(struct visibility *visibility, int scene_count, uint32_t x0, uint32_t y0,
                      uint32_t wide, uint32_t high) {
    const uint32_t region_width = visibility->bins.grid.region_width;
    struct packet *packet = visibility->packet;
    visibility->rays += wide * high;
    aim_packet(packet, x0, y0, wide, high);
    for (int i = 0; i < scene_count; i++)
        if (visibility->scenes[i].scene)
            cast_packet(packet, &visibility->scenes[i]);
    for (unsigned dy = 0; dy < high; dy++)
        for (unsigned dx = 0; dx < wide; dx++) {
            const unsigned lane = dy * TILE_SAMPLES + dx;
            if (packet->lanes.depth[lane] == INFINITY)
                continue;
            const uint32_t sample = (y0 + dy) * region_width + x0 + dx;
            visibility->depth[sample] = packet->lanes.depth[lane];
            visibility->triangle[sample] = packet->lanes.triangle[lane];
        }
}

static void cast_region(struct visibility *visibility, uint32_t region) {
    const struct region_bins *bins = &visibility->bins;
    const struct region_grid *grid = &bins->grid;
    const struct region_bin *rare = visibility->rare_bins.bins[region];
    region_grid_origin(grid, region, &visibility->origin_x, &visibility->origin_y);
    const uint32_t origin_x = visibility->origin_x, origin_y = visibility->origin_y;
    const uint32_t wide = grid->samples_wide - origin_x < grid->region_width
                              ? grid->samples_wide - origin_x
                              : grid->region_width,
                   high = grid->samples_high - origin_y < grid->region_height
                              ? grid->samples_high - origin_y
                              : grid->region_height;
    for (uint32_t x = 0; x < wide; x++)
        visibility->screen_x[x] = region_grid_screen_x(grid, &visibility->frame, origin_x + x);
    for (uint32_t y = 0; y < high; y++)
        visibility->screen_y[y] = region_grid_screen_y(grid, &visibility->frame, origin_y + y);
    memset(visibility->triangle, 0xff,
           (size_t)grid->region_width * grid->region_height * sizeof *visibility->triangle);
    for (uint32_t row = 0; row * TILE_SAMPLES < high; row++)
        for (uint32_t column = 0; column * TILE_SAMPLES < wide; column++) {
            if (!region_bin_has_tile(bins, bins->bins[region], column, row))
                continue;
            const uint32_t x0 = column * TILE_SAMPLES, y0 = row * TILE_SAMPLES;
            const bool has_rare = rare && region_bin_has_tile(bins, rare, column, row);
            cast_tile(visibility, has_rare ? SCENE_COUNT : SCENE_SKIPPING + 1, x0, y0,
                      wide - x0 < TILE_SAMPLES ? wide - x0 : TILE_SAMPLES,
                      high - y0 < TILE_SAMPLES ? high - y0 : TILE_SAMPLES);
        }
}

/* Parameters of `count` covered samples from `first` on that see one triangle, into the planes. */
static void interpolate_material(const struct visibility *visibility, uint32_t triangle,
                                 struct region_draft *draft, uint32_t first, uint32_t count) {
    const struct triangle_source source = visibility->sources[triangle];
    const struct chunk_payload *chunk = &visibility->chunks[source.chunk];
    const uint16_t *corner = chunk->triangles + 3 * source.triangle;
    const uint32_t slots = chunk->material_count;
    const float *m0 = chunk->material + (size_t)corner[0] * slots;
    const float *m1 = chunk->material + (size_t)corner[1] * slots;
    const float *m2 = chunk->material + (size_t)corner[2] * slots;
    for (uint32_t p = 0; p < draft->head.slots; p++) {
        float *restrict out = draft->slots + (size_t)p * draft->head.sample_count + first;
        if (p >= slots) {
            memset(out, 0, count * sizeof *out);
            continue;
        }
        visibility->kernels->interpolate((const float *const *)visibility->barycentric,
                                         (const float[3]){m0[p], m1[p], m2[p]}, count, out);
        if (chunk->formats[p].rounding != SLOT_FLOAT)
            slot_format_round(chunk->formats[p], out, count);
    }
    for (uint32_t k = 0; k < count; k++) {
        draft->primitive[first + k] = visibility->primitives[triangle];
        draft->shader[first + k] = (uint16_t)chunk->shader_id;
    }
}

static void find_spans(struct visibility *visibility) {
    const uint32_t width = visibility->bins.grid.region_width,
                   height = visibility->bins.grid.region_height;
    visibility->span_count = 0;
    for (uint32_t row = 0; row < height; row++) {
        const uint32_t *triangle = visibility->triangle + (size_t)row * width;
        for (uint32_t x = 0; x < width;) {
            const uint32_t first = x, seen = triangle[x];
            while (x < width && triangle[x] == seen)
                x++;
            if (seen != UINT32_MAX)
                visibility->spans[visibility->span_count++] =
                    (struct span){seen, row * width + first, x - first};
        }
    }
}

static struct region_head measure_region(const struct visibility *visibility, uint32_t region) {
    struct region_head head = {
        .work_count = 1, .nan_depths = visibility->nan_depths, .rays = visibility->rays};
    uint32_t end = UINT32_MAX, longest_seen = 0;
    for (uint32_t i = 0; i < visibility->span_count; i++) {
        const struct span *span = &visibility->spans[i];
        const struct chunk_payload *chunk =
            &visibility->chunks[visibility->sources[span->triangle].chunk];
        head.slots = chunk->material_count > head.slots ? chunk->material_count : head.slots;
        longest_seen = chunk->map_bytes > longest_seen ? chunk->map_bytes : longest_seen;
        head.sample_count += span->count;
        head.run_count += span->sample != end;
        end = span->sample + span->count;
    }
    const uint32_t longest_map = visibility->bins.bins[region]->longest_map;
    head.longest_map = longest_map > longest_seen ? longest_map : longest_seen;
    return head;
}

struct region_draft visibility_render(struct visibility *visibility, uint32_t region,
                                      uint32_t node) {
    const uint32_t width = visibility->bins.grid.region_width;
    visibility->nan_depths = visibility->rays = 0;
    cast_region(visibility, region);
    find_spans(visibility);
    struct region_draft draft = region_draft_create(measure_region(visibility, region));
    draft.work[0] = (struct region_work){node, visibility->bins.bins[region]->triangles};
    uint32_t at = 0, run = 0;
    for (uint32_t i = 0; i < visibility->span_count; i++) {
        const struct span s = visibility->spans[i];
        visibility->kernels->weigh(
            &visibility->setups[s.triangle], visibility->screen_x + s.sample % width,
            visibility->screen_y[s.sample / width], s.count, visibility->barycentric);
        interpolate_material(visibility, s.triangle, &draft, at, s.count);
        memcpy(draft.depth + at, visibility->depth + s.sample, s.count * sizeof(float));
        if (run && draft.runs[run - 1].first + draft.runs[run - 1].count == s.sample)
            draft.runs[run - 1].count += s.count;
        else
            draft.runs[run++] = (struct region_run){s.sample, s.count};
        at += s.count;
    }
    return draft;
}
