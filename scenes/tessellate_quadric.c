/* SPDX-License-Identifier: Apache-2.0 */
#include "scenes/mesh_builder.h"

#include <math.h>
#include <stdlib.h>

/* All quadrics and the torus are a profile curve in the half-plane of angle 0, turned about z. */

/* A point of the profile for one value of v. */
struct profile_point {
    struct vec3 position, dpdv;
    struct vec3
        normal; /* dPdu x dPdv for a positive sweep, of any length; exact also where dPdu is zero */
    double v;
};

struct quadric {
    const struct primitive *primitive;
    double radius_max; /* from the axis */
    double z_low, z_high;
    double sweep_radians;
    double radius, from, to; /* of the profile: of its circle or at its rim; angles or heights */
};

static double sign_of(double x) {
    return x < 0 ? -1 : 1;
}

/* An arc about (centre, 0, 0) in the xz-plane; `side` is the sign of centre times radius, or 1 on
 * the axis. */
static struct profile_point profile_arc(const struct quadric *q, double centre, double side,
                                        double row) {
    double range = q->to - q->from, angle = q->from + row * range;
    if (row >= 1) /* a full circle closes to the bit */
        angle = fabs(range) >= 2 * M_PI ? q->from : q->to;
    double c = cos(angle), s = sin(angle);
    if (fabs(c) < 1e-15) /* so does a pole */
        c = 0;
    side *= sign_of(range);
    return (struct profile_point){
        .position = {centre + q->radius * c, 0, q->radius * s},
        .dpdv = {-q->radius * s * range, 0, q->radius * c * range},
        .normal = {c * side, 0, s * side},
        .v = row,
    };
}

/* A straight line; on the axis, where dPdu is zero, the normal is that of the rest of the line. */
static struct profile_point profile_line(struct vec3 from, struct vec3 to, double row) {
    struct vec3 along = vec3_subtract(to, from), across[3];
    struct vec3 position = row <= 0   ? from
                           : row >= 1 ? to
                                      : vec3_add(vec3_scale(from, 1 - row), vec3_scale(to, row));
    const struct vec3 *points[3] = {&position, &from, &to};
    int i = 0;
    for (; i < 3; i++) {
        across[i] = vec3_make(-points[i]->y, points[i]->x, 0);
        if (across[i].x != 0 || across[i].y != 0)
            break;
    }
    return (struct profile_point){position, along, vec3_cross(across[i < 3 ? i : 2], along), row};
}

/* z = zmax (r / rmax)^2, with rows evenly spaced in r, where the chords of a parabola are equally
 * good. */
static struct profile_point profile_parabola(const struct quadric *q, double row) {
    double z_max = q->primitive->arguments[2], range = q->to - q->from;
    double share_from = sqrt(q->from / z_max), share_to = sqrt(q->to / z_max);
    double share = share_from + row * (share_to - share_from), z = z_max * share * share;
    /* The slope of r has a pole at the tip: near it that of a thirtieth of the radius is taken. */
    double slope = q->radius * range / (2 * z_max * fmax(share, 1. / 30));
    double side = sign_of(q->radius) * sign_of(range);
    return (struct profile_point){
        .position = {q->radius * share, 0, z},
        .dpdv = {slope, 0, range},
        .normal = {2 * fabs(z_max) * share * side, 0, -q->radius * sign_of(z_max) * side},
        .v = range != 0 ? (z - q->from) / range : 0,
    };
}

static struct profile_point profile_at(const struct quadric *q, double row) {
    const double *a = q->primitive->arguments;
    switch (q->primitive->kind) {
    case PRIMITIVE_SPHERE:
        return profile_arc(q, 0, 1, row);
    case PRIMITIVE_TORUS:
        return profile_arc(q, a[0], sign_of(a[0]) * sign_of(a[1]), row);
    case PRIMITIVE_CYLINDER:
        return profile_line(vec3_make(a[0], 0, a[1]), vec3_make(a[0], 0, a[2]), row);
    case PRIMITIVE_CONE:
        return profile_line(vec3_make(a[1], 0, 0), vec3_make(0, 0, a[0]), row);
    case PRIMITIVE_DISK:
        return profile_line(vec3_make(a[1], 0, a[0]), vec3_make(0, 0, a[0]), row);
    case PRIMITIVE_HYPERBOLOID:
        return profile_line(vec3_make(a[0], a[1], a[2]), vec3_make(a[3], a[4], a[5]), row);
    default:
        return profile_parabola(q, row);
    }
}

static void quadric_set_heights(struct quadric *q, double a, double b) {
    q->z_low = fmin(a, b);
    q->z_high = fmax(a, b);
}

static double sweep_argument(const struct primitive *primitive) {
    static const int index[] = {
        [PRIMITIVE_SPHERE] = 3, [PRIMITIVE_CYLINDER] = 3,   [PRIMITIVE_CONE] = 2,
        [PRIMITIVE_DISK] = 2,   [PRIMITIVE_PARABOLOID] = 3, [PRIMITIVE_HYPERBOLOID] = 6,
        [PRIMITIVE_TORUS] = 4};
    return fmax(-360, fmin(360, primitive->arguments[index[primitive->kind]])) * (M_PI / 180);
}

static double clamp_unit(double x) {
    return fmax(-1, fmin(1, x));
}

/* False when the surface has no area whatever its arguments mean. */
static bool quadric_init(struct quadric *q, const struct primitive *primitive) {
    const double *a = primitive->arguments;
    *q = (struct quadric){.primitive = primitive, .sweep_radians = sweep_argument(primitive)};
    q->radius = a[0];
    switch (primitive->kind) {
    case PRIMITIVE_SPHERE:
        q->from = asin(clamp_unit(a[1] / fabs(a[0]))) * sign_of(a[0]);
        q->to = asin(clamp_unit(a[2] / fabs(a[0]))) * sign_of(a[0]);
        quadric_set_heights(q, -fabs(a[0]), fabs(a[0]));
        break;
    case PRIMITIVE_CYLINDER:
        quadric_set_heights(q, a[1], a[2]);
        break;
    case PRIMITIVE_CONE:
        q->radius = a[1];
        quadric_set_heights(q, 0, a[0]);
        break;
    case PRIMITIVE_DISK:
        q->radius = a[1];
        quadric_set_heights(q, a[0], a[0]);
        break;
    case PRIMITIVE_PARABOLOID:
        q->from = a[2] > 0 ? fmax(a[1], 0) : fmin(a[1], 0);
        q->to = a[2];
        quadric_set_heights(q, q->from, q->to);
        if (a[2] == 0)
            return false;
        break;
    case PRIMITIVE_HYPERBOLOID:
        q->radius = fmax(hypot(a[0], a[1]), hypot(a[3], a[4]));
        quadric_set_heights(q, a[2], a[5]);
        break;
    default: /* torus */
        q->radius = a[1];
        q->from = a[2] * (M_PI / 180);
        q->to = fmax(q->from - 2 * M_PI, fmin(q->from + 2 * M_PI, a[3] * (M_PI / 180)));
        quadric_set_heights(q, -fabs(a[1]), fabs(a[1]));
        break;
    }
    q->radius_max = fabs(q->radius);
    if (primitive->kind == PRIMITIVE_PARABOLOID)
        q->radius_max *= fmax(1, sqrt(q->from / a[2]));
    if (primitive->kind == PRIMITIVE_TORUS)
        q->radius_max += fabs(a[0]);
    return q->radius_max > 0 && q->sweep_radians != 0;
}

/* A sphere is as far from an eye within it as its surface is: a sky needs no more than what is seen
 * of it. */
static double pixels_inside_sphere(const struct tessellation *t, const struct quadric *q,
                                   double pixels) {
    if (q->primitive->kind != PRIMITIVE_SPHERE || !t->is_affine || !t->camera->is_perspective)
        return pixels;
    struct vec3 eye = mat4_point(&t->camera_to_object, vec3_make(0, 0, 0));
    double gap = fabs(sqrt(vec3_dot(eye, eye)) - q->radius_max);
    return fmin(pixels, tessellation_pixels_at_distance(t, gap));
}

/* Surfaces that bend both ways share the tolerance between the ways. */
static void quadric_divide(const struct tessellation *t, const struct quadric *q, double pixels,
                           int *nu, int *nv) {
    const double *a = q->primitive->arguments;
    double half = t->chord_pixels / 2, tolerance = half, twist;
    *nv = 1;
    switch (q->primitive->kind) {
    case PRIMITIVE_SPHERE:
    case PRIMITIVE_TORUS:
        *nv = divide_arc(fabs(q->radius) * pixels, q->to - q->from, half);
        break;
    case PRIMITIVE_PARABOLOID:
        *nv = divide_curve(2 * pixels * fabs(a[2]) * pow(1 - sqrt(q->from / a[2]), 2), half);
        break;
    case PRIMITIVE_HYPERBOLOID: /* a cell between two rotated lines is twisted */
        twist = hypot(a[3] - a[0], a[4] - a[1]) * fabs(q->sweep_radians) /
                divide_arc(q->radius_max * pixels, q->sweep_radians, half);
        *nv = (int)fmin(DIVISIONS_MAX, fmax(1, ceil(twist * pixels / (4 * half))));
        break;
    default:
        tolerance = t->chord_pixels;
        break;
    }
    *nu = divide_arc(q->radius_max * pixels, q->sweep_radians, tolerance);
}

static struct vec3 turn(struct vec3 p, double c, double s) {
    return vec3_make(p.x * c - p.y * s, p.x * s + p.y * c, p.z);
}

static double bilinear(const double *corners, double u, double v) {
    return (corners[0] * (1 - u) + corners[2] * u) * (1 - v) +
           (corners[4] * (1 - u) + corners[6] * u) * v;
}

static void put_row(struct mesh_builder *builder, const struct quadric *q, const double *turns,
                    int nu, int row, int nv) {
    const double *corners = builder->tessellation->texture_coordinates;
    struct profile_point profile = profile_at(q, row == nv ? 1 : (double)row / nv);
    struct vertex_source source = {.corner_count = 4, .point_count = 4};
    for (size_t i = 0; i < 4; i++)
        source.varying[i] = source.facevarying[i] = source.points[i] = i;
    double v = row == nv ? 1 : profile.v, side = sign_of(q->sweep_radians);
    for (int i = 0; i <= nu; i++) {
        double u = i == nu ? 1 : (double)i / nu, c = turns[2 * i], s = turns[2 * i + 1];
        struct surface_point point = {.u = u, .v = v, .s = bilinear(corners, u, v)};
        point.t = bilinear(corners + 1, u, v);
        point.position = turn(profile.position, c, s);
        point.dpdu =
            vec3_make(-point.position.y * q->sweep_radians, point.position.x * q->sweep_radians, 0);
        point.dpdv = turn(profile.dpdv, c, s);
        point.normal = vec3_scale(turn(profile.normal, c, s), side);
        const double weights[4] = {(1 - u) * (1 - v), u * (1 - v), (1 - u) * v, u * v};
        for (int k = 0; k < 4; k++)
            source.corner_weights[k] = source.point_weights[k] = weights[k];
        mesh_builder_put(builder, (size_t)row * ((size_t)nu + 1) + (size_t)i, &point, &source);
    }
}

bool tessellate_quadric(struct tessellation *t, const struct primitive *primitive,
                        struct scene_mesh *mesh, struct status *status) {
    struct quadric q;
    struct mesh_builder builder;
    int nu, nv;
    if (!quadric_init(&q, primitive))
        return true;
    struct bounds bounds = {{-q.radius_max, -q.radius_max, q.z_low},
                            {q.radius_max, q.radius_max, q.z_high}};
    struct visibility visibility = tessellation_visibility(t, &bounds);
    if (visibility.is_outside)
        return true;
    quadric_divide(t, &q, pixels_inside_sphere(t, &q, visibility.pixels_per_unit), &nu, &nv);
    size_t columns = (size_t)nu + 1, rows = (size_t)nv + 1;
    if (!mesh_builder_start(&builder, t, primitive, columns * rows, 2 * (size_t)nu * (size_t)nv,
                            texture_coordinates_are_uv(t->texture_coordinates), mesh, status))
        return false;
    double *turns = memory_get(2 * columns, sizeof *turns);
    bool is_closed = fabs(q.sweep_radians) >= 2 * M_PI;
    for (int i = 0; i <= nu; i++) {
        /* The seam of a full turn closes to the bit. */
        double angle = is_closed && i == nu ? 0 : q.sweep_radians * ((double)i / nu);
        turns[2 * i] = cos(angle);
        turns[2 * i + 1] = sin(angle);
    }
    for (int row = 0; row <= nv; row++)
        put_row(&builder, &q, turns, nu, row, nv);
    free(turns);
    mesh_builder_grid(&builder, 0, (size_t)nu, (size_t)nv);
    mesh_builder_finish(&builder, mesh, &t->dropped_triangles);
    return true;
}
