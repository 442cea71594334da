/* SPDX-License-Identifier: Apache-2.0 */
#include "shader_harness.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

/* Standard functions against their definitions in plain C; every width must give the same bits. */

static const int widths[] = {4, 8, 16};

static void run(const char *source, struct harness_result *result) {
    for (int w = 0; w < 3; w++) {
        struct harness h;
        struct harness_result one;
        harness_open(&h, source, widths[w], NULL);
        harness_run(&h, NULL, 0, &one);
        harness_close(&h);
        if (w)
            assert_memory_equal(one.color, result->color, sizeof one.color);
        *result = one;
    }
}

/* The surface sets Ci; `expected` says what its components are where s is i. */
static void assert_colors(const char *source, void (*expected)(double i, double color[3])) {
    struct harness_result result;
    run(source, &result);
    for (int n = 0; n < HARNESS_SAMPLES; n++) {
        double color[3];
        expected((double)n, color);
        for (int c = 0; c < 3; c++)
            if (!(fabs((double)result.color[c][n] - color[c]) <= 2e-5 * (1 + fabs(color[c]))))
                fail_msg("%s\ncomponent %d at s = %d is %g, not %g", source, c, n,
                         (double)result.color[c][n], color[c]);
    }
}

/* All that a compilation warns of, one line each, without place and excerpt. */
static void assert_warnings(const char *source, const char *wanted) {
    struct status status = {0};
    struct shader_program *program = harness_compile(source, NULL, &status);
    char all[4096] = "";
    if (!program)
        fail_msg("%s", status.message);
    for (int i = 0; i < program->warning_count; i++) {
        const char *text = strstr(program->warnings[i], "warning: ") + 9, *end = strchr(text, '\n');
        snprintf(all + strlen(all), sizeof all - strlen(all), "%.*s\n", (int)(end - text), text);
    }
    assert_string_equal(all, wanted);
    shader_program_destroy(program);
}

static void turned(double i, double color[3]) {
    double a = i / 3;
    color[0] = 1 + 2 * cos(a) + 5 * sin(a);
    color[1] = 1 - 2 * sin(a) + 5 * cos(a);
    color[2] = i;
}

static void rotate_turns_about_a_line(void **state) {
    /* about the line through (1, 1, *) along -z */
    assert_colors("surface a() { Ci = color (rotate(point (3, 6, s), s / 3, point (1, 1, 2), "
                  "point (1, 1, -1))); }",
                  turned);
}

static void distances(double i, double color[3]) {
    color[0] = i <= 4 ? hypot(4 - i, 3) : i <= 10 ? 3 : hypot(i - 10, 3);
    color[1] = hypot(i, 3);
    color[2] = 3.14159265358979;
}

static void ptlined_is_the_distance_to_a_stretch(void **state) {
    assert_colors("surface a() { Ci = color (ptlined(point (4, 0, 0), point (10, 0, 0), point (s, "
                  "3, 0)), ptlined(point (0, 0, 0), point (0, 0, 0), point (s, 3, 0)), PI); }",
                  distances);
}

static void glass(double i, double color[3]) {
    double angle = i / 12, eta = 1 / 1.5, c = cos(angle), t = asin(eta * sin(angle));
    double g = sqrt(1 / (eta * eta) - 1 + c * c), a = (g - c) / (g + c);
    double b = (c * (g + c) - 1) / (c * (g - c) + 1);
    color[0] = 0.5 * a * a * (1 + b * b);
    color[1] = cos(angle);
    color[2] = -cos(t);
}

static void fresnel_gives_directions_when_asked(void **state) {
    assert_colors("surface a() { float kr, kt; vector r, t; vector i = vector (sin(s / 12), 0, "
                  "-cos(s / 12));\n"
                  "  fresnel(i, normal (0, 0, 1), 1 / 1.5, kr, kt, r, t);\n"
                  "  if (abs(kr + kt - 1) > 0.000001) kr = -1;\n"
                  "  Ci = color (kr, zcomp(r), zcomp(t)); }",
                  glass);
}

static void yiq(double i, double color[3]) {
    double r = i / 10, g = 0.25, b = 0.75;
    color[0] = 0.299 * r + 0.587 * g + 0.114 * b;
    color[1] = 0.596 * r - 0.275 * g - 0.321 * b;
    color[2] = 0.212 * r - 0.523 * g + 0.311 * b;
}

static void xyz(double i, double color[3]) {
    double r = i / 10, g = 0.25, b = 0.75;
    color[0] = 0.412453 * r + 0.357580 * g + 0.180423 * b;
    color[1] = 0.212671 * r + 0.715160 * g + 0.072169 * b;
    color[2] = 0.019334 * r + 0.119193 * g + 0.950227 * b;
}

static void back(double i, double color[3]) {
    color[0] = i / 10;
    color[1] = 0.25;
    color[2] = 0.75;
}

static void color_spaces_are_the_television_engineers(void **state) {
    assert_colors("surface a() { Ci = ctransform(\"YIQ\", color (s / 10, 0.25, 0.75)); }", yiq);
    assert_colors("surface a() { Ci = ctransform(\"xyz\", color (s / 10, 0.25, 0.75)); }", xyz);
    assert_colors("surface a() { color c = color (s / 10, 0.25, 0.75);\n"
                  "  Ci = 0.5 * ctransform(\"YIQ\", \"rgb\", ctransform(\"YIQ\", c)) +\n"
                  "       0.5 * ctransform(\"xyz\", \"rgb\", ctransform(\"xyz\", c)); }",
                  back);
}

static void old(double i, double color[3]) {
    color[0] = i;
    color[1] = -1;
    color[2] = 1;
}

/* Shaders older than the types vector and normal say point. */
static void points_serve_as_directions(void **state) {
    assert_colors("point turn(point n; point i) { return faceforward(normalize(n), i); }\n"
                  "surface a(point from = point \"camera\" (0, 0, 0); float unused = 0;) {\n"
                  "  point Nf = turn(N, I), V = normalize(-I), d = P - from;\n"
                  "  point R = reflect(normalize(I), Nf);\n"
                  "  point side = Nf ^ V; setxcomp(d, xcomp(d) + length(side));\n"
                  "  Ci = color (xcomp(d), zcomp(R) * (Nf . Nf), V . Nf)\n"
                  "     + diffuse(Nf) + specular(Nf, V, 0.1); }",
                  old);
}

static void missing_parts_have_a_value_and_a_warning(void **state) {
    const char *source =
        "surface a(string map = \"wood.tif\"; float Kd = 0.5;) {\n"
        "  float f = 7, g;\n"
        "  color c = texture(map, s, t, \"blur\", 0.1) + color environment(\"sky\", reflect(I, "
        "N));\n"
        "  float d = texture(map[1]) + shadow(\"s.z\", P);\n"
        "  g = surface(\"Kd\", f) + lightsource(\"intensity\", f) + attribute(\"name\", c) + Kd;\n"
        "  printf(\"%f\", f); string n = format(\"%d\", f);\n"
        "  Ci = color (comp(c, 0), d, g + f) * (n == \"7\" ? 1 : 9) * (1 - match(\"a\", map)) \n"
        "     + trace(P, N); }";
    struct harness_result result;
    run(source, &result);
    assert_true(result.color[0][3] == 1 && result.color[1][3] == 1 && result.color[2][3] == 7.5f);
    assert_warnings(source, "texture() is always 1: there are no image textures\n"
                            "environment() is always 0: there are no image textures\n"
                            "texture() is always 1: there are no image textures\n"
                            "shadow() is always 0: there are no shadows\n"
                            "printf is ignored\n"
                            "trace() is always 0: there is no ray tracing\n"
                            "surface(\"Kd\") is 0: there is no such shader here\n"
                            "lightsource(\"intensity\") is 0: lights are asked inside illuminance\n"
                            "attribute(\"name\") is 0: it is not known here\n");
}

static void strings_written_out_are_joined(void **state) {
    struct harness_result result;
    const char *source = "surface a(string where = concat(\"wor\", \"ld\");) {\n"
                         "  string f = format(\"shader\");\n"
                         "  Ci = color (where == \"world\" ? 1 : 0, f == \"shader\" ? 1 : 0,\n"
                         "    xcomp(transform(concat(\"cam\", \"era\"), P))); }";
    run(source, &result);
    assert_true(result.color[0][5] == 1 && result.color[1][5] == 1 && result.color[2][5] == 5);
    assert_warnings(source, "");
}

/* Each basis by its meaning, not by its matrix. */
static const double knots[10] = {3, 1, 4, 1.5, 9, 2.5, 6, 5, 3.5, 8};

static double mixed(double a, double b, double t) {
    return a + (b - a) * t;
}

static double bezier(const double *v, double t) { /* de Casteljau */
    double a = mixed(v[0], v[1], t), b = mixed(v[1], v[2], t), c = mixed(v[2], v[3], t);
    return mixed(mixed(a, b, t), mixed(b, c, t), t);
}

static double hermite(double from, double from_slope, double to, double to_slope, double t) {
    const double v[4] = {from, from + from_slope / 3, to - to_slope / 3, to};
    return bezier(v, t);
}

static double bspline(const double *v, double t) { /* de Boor */
    double a = mixed(v[0], v[1], (t + 2) / 3), b = mixed(v[1], v[2], (t + 1) / 3),
           c = mixed(v[2], v[3], t / 3);
    return mixed(mixed(a, b, (t + 1) / 2), mixed(b, c, t / 2), t);
}

static double spline_at(const char *basis, double x, int count) {
    int step = !strcmp(basis, "bezier") ? 3 : !strcmp(basis, "hermite") ? 2 : 1;
    int spans = (count - 4) / step + 1;
    x = x < 0 ? 0 : x > 1 ? 1 : x;
    int segment = (int)floor(x * spans);
    segment = segment > spans - 1 ? spans - 1 : segment;
    double t = x * spans - segment;
    const double *v = knots + segment * step;
    if (step == 3)
        return bezier(v, t);
    if (step == 2)
        return hermite(v[0], v[1], v[2], v[3], t);
    if (!strcmp(basis, "bspline"))
        return bspline(v, t);
    if (!strcmp(basis, "linear"))
        return mixed(v[1], v[2], t);
    return hermite(v[1], (v[2] - v[0]) / 2, v[2], (v[3] - v[1]) / 2, t);
}

static void splines_are_what_their_names_say(void **state) {
    static const char *const names[] = {"catmull-rom", "bezier", "bspline", "hermite", "linear"};
    for (size_t b = 0; b < 5; b++)
        for (int count = 4; count <= 10; count += 6) {
            char source[1024], list[256] = "";
            struct harness_result result;
            for (int i = 0; i < count; i++)
                snprintf(list + strlen(list), sizeof list - strlen(list), "%s%g", i ? ", " : "",
                         knots[i]);
            snprintf(source, sizeof source,
                     "float at(float x; float v[]) { return spline(\"%s\", x, v); }\n"
                     "surface a() { float v[] = {%s}; float x = (s - 1) / 12.5;\n"
                     "  Ci = color (spline(\"%s\", x, %s), at(x, v), spline(\"%s\", 0.3, v)); }",
                     names[b], list, names[b], list, names[b]);
            run(source, &result);
            for (int n = 0; n < HARNESS_SAMPLES; n++) {
                double wanted = spline_at(names[b], (n - 1) / 12.5, count);
                if (fabs((double)result.color[0][n] - wanted) > 2e-5)
                    fail_msg("%s of %d at s = %d is %g, not %g", names[b], count, n,
                             (double)result.color[0][n], wanted);
                assert_true(result.color[1][n] == result.color[0][n]);
                assert_true(fabs((double)result.color[2][n] - spline_at(names[b], 0.3, count)) <
                            2e-5);
            }
        }
}

static void spline_of_triples(double i, double color[3]) {
    for (int c = 0; c < 3; c++)
        color[c] = spline_at("catmull-rom", i / 15, 4 + 1) * (c == 1 ? 2 : 1) + (c == 2);
}

static void splines_of_colors_and_points_go_by_component(void **state) {
    assert_colors("surface a() { Ci = spline(s / 15, color (3, 6, 4), (1, 2, 2), (4, 8, 5), "
                  "color (1.5, 3, 2.5), (9, 18, 10)); }",
                  spline_of_triples);
    assert_colors("surface a() { point p[5] = {(3, 6, 4), (1, 2, 2), (4, 8, 5), (1.5, 3, 2.5), "
                  "(9, 18, 10)}; Ci = color spline(s / 15, p); }",
                  spline_of_triples);
}

static void assert_each(const struct harness_result *result, int component, double low,
                        double high) {
    for (int n = 0; n < HARNESS_SAMPLES; n++) {
        double value = (double)result->color[component][n];
        if (!(value >= low && value <= high))
            fail_msg("component %d at s = %d is %g", component, n, value);
    }
}

static int different(const struct harness_result *result, int component) {
    int count = 0;
    for (int n = 0; n < HARNESS_SAMPLES; n++) {
        bool is_new = true;
        for (int m = 0; m < n; m++)
            is_new &= result->color[component][m] != result->color[component][n];
        count += is_new;
    }
    return count;
}

static void cell_noise_is_one_value_for_each_cell(void **state) {
    struct harness_result result;
    run("surface a() { Ci = color (cellnoise(s / 4 - 2), cellnoise(point (s / 4, 0.5, 7.9)) - "
        "cellnoise(point (floor(s / 4), 0, 7)), cellnoise(P, s)); }",
        &result);
    assert_int_equal(different(&result, 0), 4);
    assert_each(&result, 0, 0, 0.99999994);
    assert_each(&result, 1, 0, 0);
    assert_int_equal(different(&result, 2), 16);
    run("surface a() { color c = cellnoise(s, t); float f = cellnoise(s, t); point p = "
        "cellnoise(1.5);\n"
        "  Ci = color (comp(c, 0) - f, comp(c, 1), xcomp(p) - cellnoise(1)); }",
        &result);
    assert_each(&result, 0, 0, 0);
    assert_int_equal(different(&result, 1), 16);
    assert_each(&result, 2, 0, 0);
}

static void noise_in_four_dimensions_is_smooth_and_centred(void **state) {
    struct harness_result result;
    /* 1/2 on the lattice; continuous across cells; the time axis matters */
    run("surface a() { point p = point (s * 0.3, 0.4, 0.7);\n"
        "  Ci = color (noise(point (s, 2, -3), 5), \n"
        "    abs(noise(p, s - 0.0001) - noise(p, s + 0.0001)), noise(p, s * 0.37)); }",
        &result);
    assert_each(&result, 0, 0.5, 0.5);
    assert_each(&result, 1, 0, 0.001);
    assert_each(&result, 2, 0, 1);
    assert_true(different(&result, 2) > 12);
    run("surface a() { color c = noise(P * 0.31, t); float f = noise(P * 0.31, t), i, sum = 0;\n"
        "  for (i = 0; i < 200; i += 1) sum += noise(P * 0.23 * i, i * 0.71);\n"
        "  Ci = color (comp(c, 0) - f, comp(c, 2), sum / 200); }",
        &result);
    assert_each(&result, 0, 0, 0);
    assert_true(different(&result, 1) > 12);
    assert_each(&result, 2, 0.42, 0.58);
}

static void periodic_noise_repeats(void **state) {
    struct harness_result result;
    run("surface a() { float x = s / 4 + 0.125; point p = point (x, 0.25, 1.75);\n"
        "  Ci = color (pnoise(x, 3) - pnoise(x - 9, 3.5), \n"
        "    pnoise(p, point (2, 5, 7)) - pnoise(p + vector (4, -5, 14), point (2, 5, 7)),\n"
        "    pnoise(p, x, point (2, 5, 7), 4) - pnoise(p, x + 8, point (2, 5, 7), 4)); }",
        &result);
    for (int c = 0; c < 3; c++)
        assert_each(&result, c, 0, 0);
    run("surface a() { float x = s * 0.37; color c = pnoise(x, t, 4, 8);\n"
        "  Ci = color (pnoise(x, 100), comp(c, 1), \n"
        "    abs(pnoise(s - 0.0001, 5) - pnoise(s + 0.0001, 5)) + comp(c, 0) - pnoise(x, t, 4, "
        "8)); "
        "}",
        &result);
    assert_each(&result, 0, 0, 1);
    assert_true(different(&result, 0) > 8 && different(&result, 1) > 8);
    assert_each(&result, 2, 0, 0.001);
}

static void noises_of_uniform_values_are_the_same(void **state) {
    struct harness_result result;
    run("surface a(float k = 0.3;) { float z = s * 0 + k;\n"
        "  Ci = color (cellnoise(k, 7) - cellnoise(z, 7),\n"
        "    noise(point (k, 1.25, 2), k) - noise(point (z, 1.25, 2), z),\n"
        "    pnoise(k, 4) + xcomp(point pnoise(k, 4)) - 2 * pnoise(z, 4)); }",
        &result);
    for (int c = 0; c < 3; c++)
        assert_each(&result, c, 0, 0);
}

static void random_differs_by_call_and_sample_but_not_by_run(void **state) {
    struct harness_result result, again;
    const char *source =
        "surface a() { float i, sum = 0; for (i = 0; i < 100; i += 1) sum += random();\n"
        "  if (s > 7) sum += random();\n"
        "  color c = random(); Ci = color (comp(c, 0), comp(c, 1), sum / 100); }";
    run(source, &result);
    run(source, &again);
    assert_memory_equal(&result.color, &again.color, sizeof again.color);
    assert_int_equal(different(&result, 0), 16);
    assert_int_equal(different(&result, 2), 16);
    assert_each(&result, 0, 0, 0.99999994);
    assert_each(&result, 2, 0.35, 0.65);
    for (int n = 0; n < HARNESS_SAMPLES; n++)
        assert_true(result.color[0][n] != result.color[1][n]);
}

static void by_rows(double i, double color[3]) {
    /* (i, 2, 3, 1) times the rows below, and again */
    double p[3] = {i * 2 + 3 * 0.5 + 10, 2 * 3 - i + 20, 3 * 4 + 2 + 30};
    color[0] = p[0] * 2 + p[2] * 0.5 + 10;
    color[1] = p[1] * 3 - p[0] + 20;
    color[2] = p[2] * 4 + p[1] + 30;
}

#define MATRIX_M "matrix m = (2, -1, 0, 0,  0, 3, 1, 0,  0.5, 0, 4, 0,  10, 20, 30, 1);\n"

static void matrices_apply_to_row_vectors(void **state) {
    assert_colors("surface a() { " MATRIX_M "Ci = color (transform(m * m, P)); }", by_rows);
    assert_colors(
        "matrix twice(matrix x) { return x * x; }\n"
        "void change(output matrix x; float k) { setcomp(x, 3, k, comp(x, 3, k) * 1); x *= 1; }\n"
        "surface a() { " MATRIX_M "matrix n = m; n *= m; change(n, mod(s, 4));\n"
        "  n = s > 7 ? n : twice(m);\n"
        "  if (s > 3) { n = n / 2; n = 2 * n; }\n"
        "  Ci = color (transform(n, P)); }",
        by_rows);
}

static void unchanged(double i, double color[3]) {
    color[0] = i;
    color[1] = 2;
    color[2] = 3;
}

static void dividing_by_a_matrix_undoes_it(void **state) {
    assert_colors("surface a() { " MATRIX_M "Ci = color (transform(m / m, P)); }", unchanged);
    assert_colors("surface a() { matrix k = (1, s, 2, 0.5, 0, 1, 3, 1, 4, 0, 1, 0, 1, 2, 0, 1);\n"
                  "  matrix i = 1 / k, one = i * k; float r, c, worst = 0;\n"
                  "  for (r = 0; r < 4; r += 1) for (c = 0; c < 4; c += 1)\n"
                  "    worst = max(worst, abs(comp(one, r, c) - (r == c ? 1 : 0)));\n"
                  "  Ci = color (worst < 0.00002 ? s : -1, 2, 3); }",
                  unchanged);
}

static void of_matrices(double i, double color[3]) {
    color[0] = 2 * (3 * 4 - 0) - -1 * (0 * 4 - 1 * 0.5);
    color[1] = 2 * i;
    color[2] = 7;
}

static void determinants_and_cells(void **state) {
    assert_colors("surface a() { " MATRIX_M "matrix z = 0; setcomp(z, 1, 2, s); z = z * 2;\n"
                  "  Ci = color (determinant(m), comp(z, 1, 2), comp(matrix 7, 9, 3)); }",
                  of_matrices);
}

static void placed(double i, double color[3]) {
    double a = i / 5, x = 3 * i, y = 2, z = 3;
    color[0] = x * cos(a) - y * sin(a) + 5;
    color[1] = x * sin(a) + y * cos(a) + 6;
    color[2] = z + 7;
}

static void translate_rotate_and_scale_come_before_what_is_there(void **state) {
    assert_colors(
        "surface a() {\n"
        "  matrix m = scale(rotate(translate(1, (5, 6, 7)), s / 5, (0, 0, 2)), (3, 1, 1));\n"
        "  Ci = color (transform(m, P)); }",
        placed);
    assert_colors("surface a() { vector axis = vector (1, 2, 3);\n"
                  "  point p = transform(rotate(1, s, axis), P), q = rotate(P, s, point (0, 0, 0), "
                  "point (0, 0, 0) + axis);\n"
                  "  Ci = color (distance(p, q) < 0.00002 ? s : -1, 2, 3); }",
                  unchanged);
}

static void normals_stay_normal_to_surfaces(void **state) {
    assert_colors("surface a() { " MATRIX_M
                  "vector v = vector (s, 1, 2); normal n = normal (1, 0, -s / 2);\n"
                  "  float before = v . n, after = vtransform(m, v) . ntransform(m, n);\n"
                  "  Ci = color (abs(before) + abs(after) < 0.00002 ? s : -1, 2, 3); }",
                  unchanged);
}

static void matrices_of_spaces_are_those_of_points(void **state) {
    struct harness h;
    struct harness_result result;
    harness_open(&h,
                 "surface a() { point p = point \"shader\" (s, 1, 2);\n"
                 "  Ci = color (p) - color (transform(matrix \"shader\" 1, point (s, 1, 2))); }",
                 8, NULL);
    for (int i = 0; i < 3; i++) {
        h.matrices.to_camera[SHADER_SPACE_SHADER][i * 5] = 2;
        h.matrices.to_camera[SHADER_SPACE_SHADER][12 + i] = 10;
    }
    harness_run(&h, NULL, 0, &result);
    for (int c = 0; c < 3; c++)
        assert_each(&result, c, 0, 0);
    harness_close(&h);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(rotate_turns_about_a_line),
        cmocka_unit_test(ptlined_is_the_distance_to_a_stretch),
        cmocka_unit_test(fresnel_gives_directions_when_asked),
        cmocka_unit_test(color_spaces_are_the_television_engineers),
        cmocka_unit_test(points_serve_as_directions),
        cmocka_unit_test(missing_parts_have_a_value_and_a_warning),
        cmocka_unit_test(strings_written_out_are_joined),
        cmocka_unit_test(splines_are_what_their_names_say),
        cmocka_unit_test(splines_of_colors_and_points_go_by_component),
        cmocka_unit_test(matrices_apply_to_row_vectors),
        cmocka_unit_test(dividing_by_a_matrix_undoes_it),
        cmocka_unit_test(determinants_and_cells),
        cmocka_unit_test(translate_rotate_and_scale_come_before_what_is_there),
        cmocka_unit_test(normals_stay_normal_to_surfaces),
        cmocka_unit_test(matrices_of_spaces_are_those_of_points),
        cmocka_unit_test(cell_noise_is_one_value_for_each_cell),
        cmocka_unit_test(noise_in_four_dimensions_is_smooth_and_centred),
        cmocka_unit_test(periodic_noise_repeats),
        cmocka_unit_test(noises_of_uniform_values_are_the_same),
        cmocka_unit_test(random_differs_by_call_and_sample_but_not_by_run),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
