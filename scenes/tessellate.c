/* SPDX-License-Identifier: Apache-2.0 */
#include "scenes/tessellate.h"

#include <math.h>

/* An object nearer to the eye than this part of its radius is diced as if it were that far away. */
static const double nearest_part_of_radius = 0.05;

struct bounds bounds_empty(void) {
    return (struct bounds){{INFINITY, INFINITY, INFINITY}, {-INFINITY, -INFINITY, -INFINITY}};
}

void bounds_add(struct bounds *bounds, struct vec3 point) {
    bounds->low = vec3_make(fmin(bounds->low.x, point.x), fmin(bounds->low.y, point.y),
                            fmin(bounds->low.z, point.z));
    bounds->high = vec3_make(fmax(bounds->high.x, point.x), fmax(bounds->high.y, point.y),
                             fmax(bounds->high.z, point.z));
}

/* The largest singular value of the upper 3x3: the square root of the largest eigenvalue of M M^T,
 * in closed form for symmetric matrices. */
static double largest_scale(const struct mat4 *matrix) {
    double a[3][3], largest = 0;
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++)
            largest = fmax(largest, fabs(matrix->m[i][j]));
    if (!(largest > 0) || !isfinite(largest))
        return largest;
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++) {
            a[i][j] = 0;
            for (int k = 0; k < 3; k++)
                a[i][j] += (matrix->m[i][k] / largest) * (matrix->m[j][k] / largest);
        }
    double mean = (a[0][0] + a[1][1] + a[2][2]) / 3, spread = 0;
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++)
            spread += pow(a[i][j] - (i == j ? mean : 0), 2);
    double p = sqrt(spread / 6);
    if (p < 1e-12 * mean)
        return largest * sqrt(mean);
    struct mat4 b = {0};
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++)
            b.m[i][j] = (a[i][j] - (i == j ? mean : 0)) / p;
    double half = fmax(-1, fmin(1, mat4_determinant3(&b) / 2));
    return largest * sqrt(fmax(0, mean + 2 * p * cos(acos(half) / 3)));
}

bool tessellate(struct tessellation *t, const struct primitive *primitive, struct scene_mesh *mesh,
                struct status *status) {
    const double(*m)[4] = t->object_to_camera.m;
    t->is_affine = m[0][3] == 0 && m[1][3] == 0 && m[2][3] == 0 && m[3][3] == 1;
    double determinant = mat4_determinant3(&t->object_to_camera);
    if (determinant == 0 ||
        !isfinite(determinant)) { /* by underflow or overflow: decide at scale 1 */
        struct mat4 scaled = t->object_to_camera;
        double largest = 0;
        for (int i = 0; i < 9; i++)
            largest = fmax(largest, fabs(m[i / 3][i % 3]));
        for (int i = 0; i < 9; i++)
            scaled.m[i / 3][i % 3] /= largest;
        determinant = mat4_determinant3(&scaled);
    }
    t->flips_winding = (determinant < 0) != t->is_reversed;
    t->scale_max = largest_scale(&t->object_to_camera);
    *mesh = (struct scene_mesh){.object_to_camera = t->object_to_camera};
    switch (primitive->kind) {
    case PRIMITIVE_POLYGONS:
        return tessellate_polygons(t, primitive, mesh, status);
    case PRIMITIVE_PATCHES:
        return tessellate_patches(t, primitive, mesh, status);
    default:
        return tessellate_quadric(t, primitive, mesh, status);
    }
}

/* The camera-space box of an object-space box; false when the map is projective and the box may
 * meet the plane that it sends to infinity. */
static bool bounds_to_camera(const struct tessellation *t, const struct bounds *object,
                             struct bounds *camera) {
    const double(*m)[4] = t->object_to_camera.m;
    *camera = bounds_empty();
    for (int i = 0; i < 8; i++) {
        struct vec3 corner = {i & 1 ? object->high.x : object->low.x,
                              i & 2 ? object->high.y : object->low.y,
                              i & 4 ? object->high.z : object->low.z};
        double w = corner.x * m[0][3] + corner.y * m[1][3] + corner.z * m[2][3] + m[3][3];
        if (!(w > 0))
            return false;
        bounds_add(camera, mat4_point(&t->object_to_camera, corner));
    }
    return true;
}

/* Whether the box lies wholly on the far side of one plane of the view; a pixel of margin all
 * around. */
static bool box_is_outside(const struct scene_camera *camera, const struct bounds *box) {
    if (box->high.z < camera->near_plane || box->low.z > camera->far_plane)
        return true;
    const double *window = camera->screen_window;
    double margin_x = (window[1] - window[0]) / camera->width;
    double margin_y = (window[3] - window[2]) / camera->height;
    double left = window[0] - margin_x, right = window[1] + margin_x;
    double bottom = window[2] - margin_y, top = window[3] + margin_y;
    if (!camera->is_perspective)
        return box->high.x < left || box->low.x > right || box->high.y < bottom || box->low.y > top;
    /* The largest of x - left z over the box is at a corner, found per term. */
    return box->high.x - fmin(left * box->low.z, left * box->high.z) < 0 ||
           box->low.x - fmax(right * box->low.z, right * box->high.z) > 0 ||
           box->high.y - fmin(bottom * box->low.z, bottom * box->high.z) < 0 ||
           box->low.y - fmax(top * box->low.z, top * box->high.z) > 0;
}

struct visibility tessellation_visibility(const struct tessellation *t,
                                          const struct bounds *bounds) {
    const struct scene_camera *camera = t->camera;
    const double *window = camera->screen_window;
    double pixels =
        fmax(camera->width / (window[1] - window[0]), camera->height / (window[3] - window[2]));
    struct bounds box;
    if (!bounds_to_camera(t, bounds, &box))
        return (struct visibility){false, INFINITY};
    struct visibility visibility = {box_is_outside(camera, &box), pixels * t->scale_max};
    if (!camera->is_perspective)
        return visibility;
    struct vec3 size = vec3_subtract(box.high, box.low);
    double radius = sqrt(vec3_dot(size, size)) / 2;
    double nearest = fmax(fmax(box.low.z, camera->near_plane), nearest_part_of_radius * radius);
    /* Depth also moves a point across the image, in proportion to how far off the axis it is seen.
     */
    double x = fmax(fabs(window[0]), fabs(window[1])), y = fmax(fabs(window[2]), fabs(window[3]));
    visibility.pixels_per_unit *= sqrt(1 + x * x + y * y) / nearest;
    return visibility;
}

double tessellation_pixels_at_distance(const struct tessellation *t, double distance) {
    const struct scene_camera *camera = t->camera;
    const double *window = camera->screen_window;
    double pixels =
        fmax(camera->width / (window[1] - window[0]), camera->height / (window[3] - window[2]));
    double x = fmax(fabs(window[0]), fabs(window[1])), y = fmax(fabs(window[2]), fabs(window[3]));
    /* 1 / the largest scale of the inverse is the smallest scale of the map. Within the view, depth
     * is at least the distance over sqrt(1 + x^2 + y^2). */
    double depth = distance / largest_scale(&t->camera_to_object) / sqrt(1 + x * x + y * y);
    return pixels * t->scale_max * sqrt(1 + x * x + y * y) / depth;
}

int divide_arc(double radius_pixels, double sweep_radians, double tolerance) {
    double share = fabs(sweep_radians) / (2 * M_PI), part = tolerance / radius_pixels;
    double per_revolution = part >= 1 ? 0 : M_PI / acos(1 - part);
    if (!(per_revolution < DIVISIONS_MAX))
        per_revolution = DIVISIONS_MAX;
    per_revolution = fmax(per_revolution, CIRCLE_DIVISIONS_MIN);
    return (int)fmax(1, ceil(per_revolution * share - 1e-9));
}

int divide_curve(double second_derivative_pixels, double tolerance) {
    if (!(second_derivative_pixels > 0))
        return 1;
    double count = sqrt(second_derivative_pixels / (8 * tolerance));
    return count < DIVISIONS_MAX ? (int)fmax(1, ceil(count)) : DIVISIONS_MAX;
}
