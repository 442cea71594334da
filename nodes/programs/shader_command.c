/* SPDX-License-Identifier: Apache-2.0 */
#include "nodes/programs/shader_command.h"

#include "nodes/programs/json_output.h"
#include "nodes/programs/program_process.h"
#include "nodes/programs/render_options.h"

#include <errno.h>
#include <getopt.h>
#include <stdlib.h>
#include <string.h>

enum { LIST_MAX = 64, SOURCE_BYTES_MAX = 1 << 20 };

struct shader_options {
    struct shader_study_options study;
    const char *definitions[LIST_MAX], *material[LIST_MAX], *lights[LIST_MAX], *folders[LIST_MAX];
    const char *machine, *json, *svg, *output, *fast_calls;
    const char *fix_scene; /* NULL: no conversion to fixed-point */
    double max_error, outliers;
    int frames, memory_bytes;
    bool renders, writes_png, explains, prints_c;
    int width, height;
    char machine_file[4096], library[2][4096], own_folder[4096];
};

static void print_help(void) {
    puts(
        "usage: sortlast shader FILE.sl [options]\n\n"
        "Says what a shader costs: parameters and transfer map, pixel memory, time per region.\n\n"
        "  -D NAME=VALUE[,VALUE...]   bind a parameter (may be repeated)\n"
        "  --material NAME[,NAME...]  parameters that come with the samples\n"
        "  --light NAME               a light it runs under (may be repeated; default: ambient and "
        "distant)\n"
        "  --shaders FOLDER           where lights and included files are looked for, too\n"
        "  --link FILE.so             let it call the extern \"C\" functions of this object\n"
        "  --machine NAME|FILE        whose prices and memory (default pixelflow)\n"
        "  --math exact|fast          compile with the fast functions of the paper\n"
        "  --fast-calls LINE:COLUMN[,LINE:COLUMN...]  these calls alone (the report lists them)\n"
        "  --json FILE                the report for programs; - is standard output\n"
        "  --svg FILE                 the lifetimes of variables in pixel memory, drawn\n"
        "  --explain                  what each optimisation saved\n"
        "  --dump PASS                the program as it is after a pass of the compiler\n"
        "  --without PASS[,PASS...]   leave passes out that only save cost\n"
        "  --c                        the C that is compiled\n"
        "  --source                   the shader again, functions inlined and vectors taken apart\n"
        "  --render                   shade a grid facing the eye, s and t from 0 to 1\n"
        "    -o FILE.exr                picture to write (default SHADER.exr)\n"
        "    --png                      and a PNG beside it\n"
        "    --format WxH               samples, both even (default 512x512)\n"
        "  --fix SCENE.rib            make a surface shader fixed-point, as the scene allows\n"
        "    --max-error E              of the colours of pixels, 1/255 say (default 2/255)\n"
        "    --outliers SHARE           of the pixels may be further off, where the shader "
        "decides\n"
        "                               (floor, if) and the limit is near (default 1e-4)\n"
        "    --frames N                 of the scene (default 1)\n"
        "    --memory BYTES             pixel memory it has to fit, instead of the machine's\n"
        "    -o FILE.sl                 the shader to write (default SHADER_fixed.sl)\n"
        "    --format WxH               pixels of the pictures (default: those of the scene)\n\n"
        "Passes, in their order (* may be left out):");
    const char *what;
    bool is_optional;
    for (int i = 0; shader_pass_name(i, &what, &is_optional); i++)
        printf("  %c %-9s %s\n", is_optional ? '*' : ' ', shader_pass_name(i, &what, &is_optional),
               what);
    puts("\ndocs/shaders.md explains the report and lists the keys of the JSON.");
}

static int failure(const struct status *status) {
    fprintf(stderr, "sortlast: %s\n", status->message);
    return status_exit_code(status->code);
}

static int usage(const char *what, const char *value) {
    fprintf(stderr, "sortlast: shader: %s%s (see sortlast shader --help)\n", what, value);
    return 1;
}

/* The pass of this name, -1 when there is none. */
static int find_pass(const char *name, size_t length) {
    const char *what, *known;
    bool is_optional;
    for (int i = 0; (known = shader_pass_name(i, &what, &is_optional)); i++)
        if (strlen(known) == length && !memcmp(known, name, length))
            return i;
    return -1;
}

static bool leave_out(struct shader_options *o, const char *list) {
    for (const char *at = list; *at;) {
        const size_t length = strcspn(at, ",");
        const int pass = find_pass(at, length);
        const char *what;
        bool is_optional = false;
        if (pass < 0 || !shader_pass_name(pass, &what, &is_optional) || !is_optional)
            return false;
        o->study.compile.passes_left_out |= 1u << pass;
        at += length + (at[length] == ',');
    }
    return true;
}

static bool add_names(const char **list, int *count, char *text) {
    for (char *save, *name = strtok_r(text, ",", &save); name; name = strtok_r(NULL, ",", &save)) {
        if (*count == LIST_MAX)
            return false;
        list[(*count)++] = name;
    }
    return true;
}

static bool parse_format(const char *text, struct shader_options *o) {
    char end;
    return sscanf(text, "%dx%d%c", &o->width, &o->height, &end) == 2 && o->width > 0 &&
           o->height > 0 && o->width % 2 == 0 && o->height % 2 == 0 && o->width <= 16384 &&
           o->height <= 16384;
}

enum option_key {
    KEY_MATERIAL = 256,
    KEY_LIGHT,
    KEY_SHADERS,
    KEY_MACHINE,
    KEY_MATH,
    KEY_JSON,
    KEY_SVG,
    KEY_EXPLAIN,
    KEY_DUMP,
    KEY_WITHOUT,
    KEY_C,
    KEY_SOURCE,
    KEY_FIX,
    KEY_MAX_ERROR,
    KEY_OUTLIERS,
    KEY_FRAMES,
    KEY_MEMORY,
    KEY_RENDER,
    KEY_PNG,
    KEY_FORMAT,
    KEY_LINK,
    KEY_FAST_CALLS,
};

static const struct option long_options[] = {{"material", 1, NULL, KEY_MATERIAL},
                                             {"light", 1, NULL, KEY_LIGHT},
                                             {"shaders", 1, NULL, KEY_SHADERS},
                                             {"machine", 1, NULL, KEY_MACHINE},
                                             {"link", 1, NULL, KEY_LINK},
                                             {"math", 1, NULL, KEY_MATH},
                                             {"fast-calls", 1, NULL, KEY_FAST_CALLS},
                                             {"json", 1, NULL, KEY_JSON},
                                             {"svg", 1, NULL, KEY_SVG},
                                             {"explain", 0, NULL, KEY_EXPLAIN},
                                             {"dump", 1, NULL, KEY_DUMP},
                                             {"without", 1, NULL, KEY_WITHOUT},
                                             {"c", 0, NULL, KEY_C},
                                             {"source", 0, NULL, KEY_SOURCE},
                                             {"fix", 1, NULL, KEY_FIX},
                                             {"max-error", 1, NULL, KEY_MAX_ERROR},
                                             {"outliers", 1, NULL, KEY_OUTLIERS},
                                             {"frames", 1, NULL, KEY_FRAMES},
                                             {"memory", 1, NULL, KEY_MEMORY},
                                             {"render", 0, NULL, KEY_RENDER},
                                             {"png", 0, NULL, KEY_PNG},
                                             {"format", 1, NULL, KEY_FORMAT},
                                             {"help", 0, NULL, 'h'},
                                             {NULL, 0, NULL, 0}};

bool shader_error_bound(const char *text, double *bound) {
    char *end;
    *bound = strtod(text, &end);
    if (end != text && *end == '/') {
        const char *divisor = end + 1;
        *bound /= strtod(divisor, &end);
        if (end == divisor)
            return false;
    }
    return end != text && !*end && *bound > 0 && *bound <= 1;
}

static bool parse_share(const char *text, double *share) {
    char *end;
    *share = strtod(text, &end);
    return end != text && !*end && *share >= 0 && *share <= 0.01;
}

static bool parse_count(const char *text, int most, int *count) {
    char *end;
    const long number = strtol(text, &end, 10);
    *count = (int)number;
    return end != text && !*end && number >= 1 && number <= most;
}

/* Takes one option; returns an exit status, -1 to go on. */
static int take_option(struct shader_options *o, int key) {
    struct shader_study_options *study = &o->study;
    switch (key) {
    case 'D':
        if (study->definition_count == LIST_MAX)
            return usage("too many definitions, at -D ", optarg);
        o->definitions[study->definition_count++] = optarg;
        return -1;
    case 'o':
        o->output = optarg;
        return -1;
    case KEY_MATERIAL:
        return add_names(o->material, &study->material_count, optarg)
                   ? -1
                   : usage("too many parameters", "");
    case KEY_LIGHT:
        return add_names(o->lights, &study->light_count, optarg) ? -1
                                                                 : usage("too many lights", "");
    case KEY_SHADERS:
        if (study->folder_count >= LIST_MAX - 4)
            return usage("too many folders, at ", optarg);
        o->folders[study->folder_count++] = optarg;
        return -1;
    case KEY_MACHINE:
        o->machine = optarg;
        return -1;
    case KEY_LINK:
        study->link = optarg;
        return -1;
    case KEY_MATH:
        study->compile.fast_math = !strcmp(optarg, "fast");
        return !strcmp(optarg, "fast") || !strcmp(optarg, "exact")
                   ? -1
                   : usage("--math is exact or fast, not ", optarg);
    case KEY_FAST_CALLS:
        o->fast_calls = optarg;
        return -1;
    case KEY_JSON:
        o->json = optarg;
        return -1;
    case KEY_SVG:
        o->svg = optarg;
        return -1;
    case KEY_DUMP:
        study->compile.dump = optarg;
        return find_pass(optarg, strlen(optarg)) >= 0 ? -1 : usage("there is no pass ", optarg);
    case KEY_WITHOUT:
        return leave_out(o, optarg) ? -1 : usage("no passes that may be left out: ", optarg);
    case KEY_FORMAT:
        return parse_format(optarg, o)
                   ? -1
                   : usage("--format is WxH, both even, from 2x2 to 16384x16384, not ", optarg);
    case KEY_EXPLAIN:
        return o->explains = true, -1;
    case KEY_C:
        return o->prints_c = true, -1;
    case KEY_SOURCE:
        return o->study.compile.writes_source = true, -1;
    case KEY_FIX:
        return o->fix_scene = optarg, -1;
    case KEY_MAX_ERROR:
        return shader_error_bound(optarg, &o->max_error)
                   ? -1
                   : usage("--max-error is above 0 and at most 1, as 0.01 or 2/255, not ", optarg);
    case KEY_OUTLIERS:
        return parse_share(optarg, &o->outliers)
                   ? -1
                   : usage("--outliers is from 0 to 0.01, not ", optarg);
    case KEY_FRAMES:
        return parse_count(optarg, 1000000, &o->frames)
                   ? -1
                   : usage("--frames is a number from 1, not ", optarg);
    case KEY_MEMORY:
        return parse_count(optarg, 65536, &o->memory_bytes)
                   ? -1
                   : usage("--memory is from 1 to 65536 bytes, not ", optarg);
    case KEY_RENDER:
        return o->renders = true, -1;
    case KEY_PNG:
        return o->writes_png = true, -1;
    case 'h':
        print_help();
        return 0;
    default:
        return usage("wrong option", "");
    }
}

static void add_folders(struct shader_options *o) {
    char program[3072];
    const char *slash = strrchr(o->study.path, '/');
    snprintf(o->own_folder, sizeof o->own_folder, "%.*s", slash ? (int)(slash - o->study.path) : 1,
             slash ? o->study.path : ".");
    o->folders[o->study.folder_count++] = o->own_folder;
    if (program_folder(program, sizeof program)) {
        snprintf(o->library[0], sizeof o->library[0], "%s/../shaders/library", program);
        snprintf(o->library[1], sizeof o->library[1], "%s/../share/sortlast/shaders", program);
        o->folders[o->study.folder_count++] = o->library[0];
        o->folders[o->study.folder_count++] = o->library[1];
    }
    o->folders[o->study.folder_count++] = SORTLAST_SOURCE "/shaders/library";
    o->study.folders = o->folders;
    o->study.definitions = o->definitions;
    o->study.material = o->material;
    o->study.lights = o->lights;
}

/* Returns an exit status, -1 to go on. */
static int parse(int argc, char **argv, struct shader_options *o) {
    *o = (struct shader_options){
        .machine = "pixelflow", .max_error = 2.0 / 255, .outliers = 1e-4, .frames = 1};
    optind = 1;
    for (int key; (key = getopt_long(argc, argv, "D:o:h", long_options, NULL)) >= 0;) {
        const int end = take_option(o, key);
        if (end >= 0)
            return end;
    }
    if (optind + 1 != argc)
        return usage(optind == argc ? "which shader?" : "one shader at a time, not also ",
                     optind == argc ? "" : argv[optind + 1]);
    o->study.path = argv[optind];
    add_folders(o);
    return -1;
}

static char *read_source(const char *path) {
    FILE *file = fopen(path, "rb");
    char *text = memory_get(SOURCE_BYTES_MAX + 1, 1);
    if (file) {
        const size_t length = fread(text, 1, SOURCE_BYTES_MAX, file);
        text[length] = 0;
        fclose(file);
    }
    return text;
}

/* The words with which `sortlast render` draws the scene with the shader in question. */
static int render_words(const struct shader_options *o, char numbers[2][32],
                        char *words[2 * LIST_MAX + 16]) {
    int count = 0;
    words[count++] = "render";
    words[count++] = (char *)o->fix_scene;
    words[count++] = "--machine";
    words[count++] = (char *)o->machine;
    for (int i = 0; i < o->study.folder_count; i++) {
        words[count++] = "--shaders";
        words[count++] = (char *)o->folders[i];
    }
    snprintf(numbers[0], 32, "%d", o->frames);
    words[count++] = "--frames";
    words[count++] = numbers[0];
    if (o->width) {
        snprintf(numbers[1], 32, "%dx%d", o->width, o->height);
        words[count++] = "--format";
        words[count++] = numbers[1];
    }
    words[count] = NULL;
    return count;
}

/* Makes the shader fixed-point as the pictures of a scene allow; returns the exit status. */
static int fix(const struct shader_options *o) {
    struct render_options *rendering = memory_get(1, sizeof *rendering);
    char numbers[2][32], *words[2 * LIST_MAX + 16], path[4096];
    struct status status = {0};
    if (render_options_parse(render_words(o, numbers, words), words, false, rendering))
        return 1; /* which has said why */
    const char *slash = strrchr(o->study.path, '/'), *name = slash ? slash + 1 : o->study.path;
    snprintf(path, sizeof path, "%.*s_fixed.sl", (int)strcspn(name, "."), name);
    struct shader_fix_request request = {
        .fix = {.path = o->study.path, .max_error = o->max_error, .outliers = o->outliers},
        .rendering = rendering->host,
        .output = o->output ? o->output : path,
        .json = o->json};
    if (o->memory_bytes)
        request.rendering.machine.pixel_memory_bytes = o->memory_bytes;
    const bool ok = shader_fix_command(&request, &status);
    render_options_finish(rendering);
    free(rendering);
    return ok ? 0 : status.code == STATUS_OK ? 128 + (int)program_stop : failure(&status);
}

static bool write_picture(const struct shader_options *o, struct shader_study *study,
                          struct status *status) {
    char path[4096];
    struct image *image;
    snprintf(path, sizeof path, "%s.exr", shader_study_program(study)->name);
    if (!image_create(o->width, o->height, &image, status))
        return false;
    static const char *const names[] = {"R", "G", "B"};
    bool ok = true;
    for (int c = 0; c < 3 && ok; c++)
        ok = image_add_channel(image, names[c], IMAGE_FLOAT) != NULL;
    if (!ok)
        status_fail(status, STATUS_LIMIT, "no memory for a picture of %dx%d", o->width, o->height);
    const char *output = o->output ? o->output : path;
    ok = ok && shader_study_run(study, (uint32_t)o->width, (uint32_t)o->height, image, status) &&
         image_write_exr(image, output, IMAGE_COMPRESSION_ZIP, NULL, status);
    if (ok && o->writes_png) {
        char png[4096];
        const size_t length = strlen(output);
        const bool has_suffix = length > 4 && !strcmp(output + length - 4, ".exr");
        snprintf(png, sizeof png, "%.*s.png", (int)(has_suffix ? length - 4 : length), output);
        ok = image_write_png(image, png, status);
    }
    image_destroy(image);
    if (ok)
        fprintf(stderr, "wrote %s\n", output);
    return ok;
}

static void collect_warnings(struct shader_study *study, struct shader_report *report) {
    static const char *warnings[LIST_MAX];
    report->warnings = warnings;
    for (const char *text; (text = shader_study_warning(study));) {
        fprintf(stderr, "%s\n", text);
        if (report->warning_count < LIST_MAX)
            warnings[report->warning_count++] = text;
    }
}

static bool write_report(const struct shader_options *o, struct shader_report *report,
                         struct status *status) {
    const bool is_quiet = (o->json && !strcmp(o->json, "-")) || (o->renders && !o->explains);
    bool ok = true;
    if (!is_quiet) {
        char *source = read_source(o->study.path);
        shader_report_print(stdout, report, source);
        free(source);
    }
    if (o->explains && !is_quiet)
        ok = shader_explain_print(stdout, &o->study, report, status);
    if (ok && o->svg) {
        char *svg = shader_report_svg(report);
        ok = text_write_file(o->svg, svg, "the chart", status);
        free(svg);
    }
    if (ok && o->json) {
        cJSON *json = shader_report_json(report);
        ok = json_write_document(o->json, json, status);
        cJSON_Delete(json);
    }
    return ok;
}

static bool examine(const struct shader_options *o, struct shader_study *study,
                    const struct machine *machine, struct status *status) {
    struct shader_report report = {
        .path = o->study.path, .program = shader_study_program(study), .machine = machine};
    collect_warnings(study, &report);
    if (o->prints_c || o->study.compile.dump || report.program->source) {
        fputs(o->prints_c             ? report.program->c_source
              : o->study.compile.dump ? report.program->dump
                                      : report.program->source,
              stdout);
        return true;
    }
    if (o->renders && !write_picture(o, study, status))
        return false;
    if (o->renders && !o->json && !o->svg && !o->explains)
        return true;
    if (report.program->kind != SHADER_KIND_IMAGER) {
        if (!shader_study_run(study, (uint32_t)machine->region_width,
                              (uint32_t)machine->region_height, NULL, status))
            return false;
        shader_study_count(study, &report.counts);
        report.is_measured = true;
    }
    return write_report(o, &report, status);
}

int shader_main(int argc, char **argv) {
    struct shader_options options, *o = &options;
    struct status status = {0};
    struct machine machine;
    struct shader_study *study;
    const int end = parse(argc, argv, o);
    if (end >= 0)
        return end;
    if (o->fix_scene)
        return fix(o);
    if (!machine_find_file(o->machine, o->machine_file, sizeof o->machine_file, &status) ||
        !machine_read_file(o->machine_file, &machine, &status))
        return failure(&status);
    o->width = o->width ? o->width : 512;
    o->height = o->height ? o->height : 512;
    o->study.compile.pixel_memory_bytes =
        o->memory_bytes ? o->memory_bytes : (int)machine.pixel_memory_bytes;
    if (o->fast_calls && !fast_calls_parse("--fast-calls", o->fast_calls, o->study.path,
                                           &o->study.fast_calls, &status))
        return failure(&status);
    bool ok = shader_study_create(&o->study, &study, &status);
    ok = ok && examine(o, study, &machine, &status);
    shader_study_destroy(study);
    fast_calls_finish(&o->study.fast_calls);
    return ok ? 0 : failure(&status);
}
