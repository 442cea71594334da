/* SPDX-License-Identifier: Apache-2.0 */
#include "images/image_compare.h"

#include "images/replacement_file.h"

#include <cjson/cJSON.h>
#include <errno.h>
#include <getopt.h>
#include <inttypes.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>
#include <unistd.h>

enum { EXIT_EQUAL = 0, EXIT_DIFFERENT = 1, EXIT_TROUBLE = 2 };

static const char compare_usage[] = "usage: sortlast compare [OPTIONS] FIRST SECOND\n";

static const char compare_help[] =
    "Compares two images (OpenEXR or PNG) channel by channel; FIRST is the reference.\n"
    "\n"
    "Without thresholds the images must be equal bit for bit. With one or more, each given\n"
    "threshold must hold, and channels of integers (identities) must still be equal. NaN and\n"
    "infinite values fail always, also when both images share them.\n"
    "\n"
    "thresholds:\n"
    "  --max-error E       largest absolute difference of any sample of a float channel\n"
    "  --max-mean E        largest mean absolute difference over all float channels\n"
    "  --max-rmse E        largest root mean square difference over all float channels\n"
    "  --min-psnr DB       smallest peak signal-to-noise ratio, peak 1, over all float channels\n"
    "  --max-flip F        largest mean of FLIP, the visible difference (0 to 1)\n"
    "  --max-flip-pixel F  largest FLIP of any pixel (0 to 1)\n"
    "  --max-over-1 SHARE  largest share of samples that differ by more than 1/255 (0 to 1)\n"
    "  --max-over-2 SHARE  largest share of samples that differ by more than 2/255 (0 to 1)\n"
    "\n"
    "output:\n"
    "  --json FILE         write the measures as JSON; - writes them to standard output, alone\n"
    "  --difference FILE   write the absolute differences as an image, .exr or .png\n"
    "  --flip-map FILE     write where FLIP sees differences: .png in colours, .exr as numbers\n"
    "  -q, --quiet         print nothing but errors\n"
    "\n"
    "what to compare:\n"
    "  --only CHANNELS     these channels alone, as in R,G,B; without it both images must have\n"
    "                      the same channels\n"
    "  --pixels-per-degree P\n"
    "                      resolution FLIP assumes; 67.02 is a 0.7 m wide 3840-pixel screen seen\n"
    "                      from 0.7 m\n"
    "  -h, --help          this text\n"
    "\n"
    "PNG values are made linear first. FLIP and SSIM clamp colours to [0,1] and need channels R, "
    "G\n"
    "and B. Errors are of linear values: one step of a PNG is 0.0003 in the dark, 0.0089 in "
    "white.\n"
    "\n"
    "exit status: 0 equal or within the thresholds, 1 different, over a threshold or not finite,\n"
    "2 trouble (a file that cannot be read or written, images that cannot be compared).\n";

/* X(NAME, option, smallest and largest value, how messages call the measure, whether it is of FLIP)
 */
#define COMPARE_THRESHOLDS(X)                                                                      \
    X(MAX_ERROR, "max-error", 0, 1e300, "max_error", false)                                        \
    X(MAX_MEAN, "max-mean", 0, 1e300, "mean_error", false)                                         \
    X(MAX_RMSE, "max-rmse", 0, 1e300, "rmse", false)                                               \
    X(MIN_PSNR, "min-psnr", -1000, 1000, "psnr_db", false)                                         \
    X(MAX_FLIP, "max-flip", 0, 1, "the mean of FLIP", true)                                        \
    X(MAX_FLIP_PIXEL, "max-flip-pixel", 0, 1, "the largest FLIP", true)                            \
    X(MAX_OVER_1, "max-over-1", 0, 1, "the share over 1/255", false)                               \
    X(MAX_OVER_2, "max-over-2", 0, 1, "the share over 2/255", false)

enum compare_threshold {
#define COMPARE_ENUM(name, option, low, high, text, flip) THRESHOLD_##name,
    COMPARE_THRESHOLDS(COMPARE_ENUM)
#undef COMPARE_ENUM
        THRESHOLD_COUNT
};

static const struct {
    double low, high;
    const char *text;
    bool is_flip;
} compare_thresholds[THRESHOLD_COUNT] = {
#define COMPARE_ENTRY(name, option, low, high, text, flip) {low, high, text, flip},
    COMPARE_THRESHOLDS(COMPARE_ENTRY)
#undef COMPARE_ENTRY
};

struct compare_command {
    const char *paths[2];
    const char *json, *difference, *flip_map, *only;
    double thresholds[THRESHOLD_COUNT]; /* NAN: not given */
    double pixels_per_degree;
    bool quiet, help;
};

enum compare_option {
    OPTION_THRESHOLD = 256, /* and those after it, one for each threshold */
    OPTION_JSON = OPTION_THRESHOLD + THRESHOLD_COUNT,
    OPTION_DIFFERENCE,
    OPTION_FLIP_MAP,
    OPTION_ONLY,
    OPTION_PIXELS_PER_DEGREE
};

static const struct option compare_options[] = {
#define COMPARE_OPTION(name, option, low, high, text, flip)                                        \
    {option, required_argument, NULL, OPTION_THRESHOLD + THRESHOLD_##name},
    COMPARE_THRESHOLDS(COMPARE_OPTION)
#undef COMPARE_OPTION
        {"json", required_argument, NULL, OPTION_JSON},
    {"difference", required_argument, NULL, OPTION_DIFFERENCE},
    {"flip-map", required_argument, NULL, OPTION_FLIP_MAP},
    {"only", required_argument, NULL, OPTION_ONLY},
    {"pixels-per-degree", required_argument, NULL, OPTION_PIXELS_PER_DEGREE},
    {"quiet", no_argument, NULL, 'q'},
    {"help", no_argument, NULL, 'h'},
    {0}};

static bool compare_number(const char *name, const char *text, double low, double high,
                           double *value, struct status *status) {
    char *end;
    errno = 0;
    *value = strtod(text, &end);
    if (end == text || *end || !(*value >= low && *value <= high))
        return status_fail(status, STATUS_INVALID, "--%s needs a number from %g to %g, not '%s'",
                           name, low, high, text);
    return true;
}

static bool compare_is(const char *path, const char *extension) {
    size_t length = strlen(path), tail = strlen(extension);
    return length > tail && strcasecmp(path + length - tail, extension) == 0;
}

static bool compare_image_name(const char *name, const char *path, struct status *status) {
    if (compare_is(path, ".exr") || compare_is(path, ".png"))
        return true;
    return status_fail(status, STATUS_INVALID, "--%s needs a file named .exr or .png, not '%s'",
                       name, path);
}

static bool compare_option(struct compare_command *command, int option, const char *name,
                           const char *argument, struct status *status) {
    const int threshold = option - OPTION_THRESHOLD;
    if (threshold >= 0 && threshold < THRESHOLD_COUNT)
        return compare_number(name, argument, compare_thresholds[threshold].low,
                              compare_thresholds[threshold].high, &command->thresholds[threshold],
                              status);
    switch (option) {
    case OPTION_PIXELS_PER_DEGREE:
        return compare_number(name, argument, 1, FLIP_PIXELS_PER_DEGREE_MAX,
                              &command->pixels_per_degree, status);
    case OPTION_JSON:
        command->json = argument;
        return true;
    case OPTION_DIFFERENCE:
        command->difference = argument;
        return compare_image_name(name, argument, status);
    case OPTION_FLIP_MAP:
        command->flip_map = argument;
        return compare_image_name(name, argument, status);
    case OPTION_ONLY:
        command->only = argument;
        return true;
    case 'q':
        command->quiet = true;
        return true;
    default:
        command->help = true;
        return true;
    }
}

static bool compare_parse(int argc, char **argv, struct compare_command *command,
                          struct status *status) {
    *command = (struct compare_command){0};
    for (int i = 0; i < THRESHOLD_COUNT; i++)
        command->thresholds[i] = NAN;
    optind = 0;
    opterr = 0;
    for (;;) {
        int index = -1;
        int option = getopt_long(argc, argv, ":qh", compare_options, &index);
        if (option == -1)
            break;
        if (option == ':')
            return status_fail(status, STATUS_INVALID, "option '%s' needs a value",
                               argv[optind - 1]);
        if (option == '?')
            return status_fail(status, STATUS_INVALID, "unknown or ambiguous option '%s'",
                               argv[optind - 1]);
        if (!compare_option(command, option, index >= 0 ? compare_options[index].name : "", optarg,
                            status))
            return false;
        if (command->help)
            return true;
    }
    if (argc - optind != 2)
        return status_fail(status, STATUS_INVALID, "two images are needed, %d given",
                           argc - optind);
    command->paths[0] = argv[optind];
    command->paths[1] = argv[optind + 1];
    return true;
}

static double compare_measure(const struct image_difference *difference,
                              enum compare_threshold threshold) {
    const struct image_measures *all = &difference->overall;
    switch (threshold) {
    case THRESHOLD_MAX_ERROR:
        return all->max_error;
    case THRESHOLD_MAX_MEAN:
        return all->mean_error;
    case THRESHOLD_MAX_RMSE:
        return all->rmse;
    case THRESHOLD_MIN_PSNR:
        return all->psnr_db;
    case THRESHOLD_MAX_FLIP:
        return difference->flip.mean;
    case THRESHOLD_MAX_FLIP_PIXEL:
        return difference->flip.max;
    case THRESHOLD_MAX_OVER_1:
        return all->over_1_255;
    default:
        return all->over_2_255;
    }
}

/* The first threshold that does not hold, or THRESHOLD_COUNT. */
static enum compare_threshold compare_broken(const struct compare_command *command,
                                             const struct image_difference *difference) {
    int i = 0;
    for (; i < THRESHOLD_COUNT; i++) {
        const double measure = compare_measure(difference, (enum compare_threshold)i);
        if (i == THRESHOLD_MIN_PSNR ? measure < command->thresholds[i]
                                    : measure > command->thresholds[i])
            break;
    }
    return (enum compare_threshold)i;
}

/* Whether a threshold is given, of any kind or of FLIP. */
static bool compare_has_threshold(const struct compare_command *command, bool of_flip) {
    for (int i = 0; i < THRESHOLD_COUNT; i++)
        if (!isnan(command->thresholds[i]) && (!of_flip || compare_thresholds[i].is_flip))
            return true;
    return false;
}

/* The verdict, and in `text` the sentence after it; a zero error is written "max_error 0" and no
 * other is. */
static int compare_judge(const struct compare_command *command,
                         const struct image_difference *difference, const char **verdict,
                         char *text, size_t size) {
    const struct image_measures *all = &difference->overall;
    uint64_t nan = all->nan[0] + all->nan[1], infinite = all->infinite[0] + all->infinite[1];
    char error[32];
    snprintf(error, sizeof error, all->max_error == 0 ? "0" : "%.6e", all->max_error);
    *verdict = "over threshold";
    if (nan + infinite) {
        *verdict = "not finite";
        snprintf(text, size, "%" PRIu64 " NaN and %" PRIu64 " infinite values in the two images",
                 nan, infinite);
        return EXIT_DIFFERENT;
    }
    const bool thresholds = compare_has_threshold(command, false);
    if (image_difference_identical(difference)) {
        *verdict = "equal";
        snprintf(text, size, "max_error 0, %d x %d pixels, %d channel%s", difference->width,
                 difference->height, difference->channel_count,
                 difference->channel_count == 1 ? "" : "s");
        return EXIT_EQUAL;
    }
    if (difference->integer_channels_differing || (!thresholds && all->max_error == 0)) {
        *verdict = "different";
        if (difference->integer_channels_differing)
            snprintf(text, size, "integers differ in %d channel%s",
                     difference->integer_channels_differing,
                     difference->integer_channels_differing == 1 ? "" : "s");
        else
            snprintf(text, size, "%" PRIu64 " zeros differ in sign", all->differing);
        return EXIT_DIFFERENT;
    }
    const enum compare_threshold broken = compare_broken(command, difference);
    if (broken != THRESHOLD_COUNT) {
        snprintf(text, size,
                 broken == THRESHOLD_MIN_PSNR ? "%s %.4f is under %g" : "%s %.6e is over %g",
                 compare_thresholds[broken].text, compare_measure(difference, broken),
                 command->thresholds[broken]);
        return EXIT_DIFFERENT;
    }
    *verdict = thresholds ? "within thresholds" : "different";
    snprintf(text, size, "max_error %s, psnr_db %.2f", error, all->psnr_db);
    return thresholds ? EXIT_EQUAL : EXIT_DIFFERENT;
}

static void compare_print(const struct image_difference *difference, int result,
                          const char *verdict, const char *text) {
    const char *plain = getenv("NO_COLOR"), *terminal = getenv("TERM");
    bool color =
        isatty(STDOUT_FILENO) && !(plain && *plain) && terminal && strcmp(terminal, "dumb") != 0;
    printf("%s%s%s: %s\n", color ? result ? "\033[31m" : "\033[32m" : "", verdict,
           color ? "\033[0m" : "", text);
    image_difference_print(difference, stdout);
}

static bool compare_write_json(const struct compare_command *command,
                               const struct image_difference *difference, int result,
                               const char *verdict, struct status *status) {
    cJSON *json = image_difference_json(difference);
    cJSON_AddStringToObject(json, "first", command->paths[0]);
    cJSON_AddStringToObject(json, "second", command->paths[1]);
    cJSON_AddStringToObject(json, "verdict", verdict);
    cJSON_AddBoolToObject(json, "passed", result == EXIT_EQUAL);
    char *text = cJSON_Print(json);
    cJSON_Delete(json);
    if (!text)
        return status_fail(status, STATUS_LIMIT, "out of memory for the JSON");
    bool done = true;
    if (strcmp(command->json, "-") == 0) {
        puts(text);
    } else {
        struct replacement_file file;
        done = replacement_file_open(&file, command->json, status);
        if (done) {
            /* A failed write is kept in the file, and the commit reports it. */
            if (replacement_file_append(&file, text, strlen(text)))
                replacement_file_append(&file, "\n", 1);
            done = replacement_file_commit(&file, status);
        }
    }
    cJSON_free(text);
    return done;
}

static bool compare_write_image(struct image *image, const char *path, struct status *status) {
    bool done = compare_is(path, ".png")
                    ? image_write_png(image, path, status)
                    : image_write_exr(image, path, IMAGE_COMPRESSION_ZIP, NULL, status);
    image_destroy(image);
    return done;
}

static bool compare_write(const struct compare_command *command, struct image *const images[2],
                          const struct image_difference *difference, int result,
                          const char *verdict, struct status *status) {
    struct image *image;
    if (command->difference &&
        !(image_difference_image(images[0], images[1], difference, &image, status) &&
          compare_write_image(image, command->difference, status)))
        return false;
    if (command->flip_map &&
        !(image_difference_flip_image(difference, compare_is(command->flip_map, ".exr"), &image,
                                      status) &&
          compare_write_image(image, command->flip_map, status)))
        return false;
    return !command->json || compare_write_json(command, difference, result, verdict, status);
}

/* Returns the exit status, EXIT_TROUBLE with *status set. */
static int compare_run(const struct compare_command *command, struct image *images[2],
                       struct image_difference *difference, struct status *status) {
    struct image_compare_options options = {.only = command->only,
                                            .pixels_per_degree = command->pixels_per_degree,
                                            .channel_perception = command->json != NULL};
    for (int i = 0; i < 2; i++)
        if (!image_read(command->paths[i], &images[i], status))
            return EXIT_TROUBLE;
    if (!image_compare(images[0], images[1], &options, difference, status))
        return EXIT_TROUBLE;
    const bool wants_flip = compare_has_threshold(command, true) || command->flip_map;
    if (wants_flip && !difference->has_color) {
        status_fail(status, STATUS_INVALID, "FLIP needs channels R, G and B in both images");
        return EXIT_TROUBLE;
    }
    const char *verdict;
    char text[256];
    int result = compare_judge(command, difference, &verdict, text, sizeof text);
    if (!command->quiet && !(command->json && strcmp(command->json, "-") == 0))
        compare_print(difference, result, verdict, text);
    if (!compare_write(command, images, difference, result, verdict, status))
        return EXIT_TROUBLE;
    if (fflush(stdout) != 0 || ferror(stdout)) {
        status_fail(status, STATUS_IO, "cannot write to standard output: %s", strerror(errno));
        return EXIT_TROUBLE;
    }
    return result;
}

int image_compare_main(int argc, char **argv) {
    struct compare_command command;
    struct status status = {0};
    if (!compare_parse(argc, argv, &command, &status)) {
        fprintf(stderr, "sortlast compare: %s\n%stry 'sortlast compare --help'\n", status.message,
                compare_usage);
        return EXIT_TROUBLE;
    }
    if (command.help) {
        printf("%s%s", compare_usage, compare_help);
        return fflush(stdout) == 0 ? EXIT_EQUAL : EXIT_TROUBLE;
    }
    struct image *images[2] = {NULL, NULL};
    struct image_difference difference = {0};
    int result = compare_run(&command, images, &difference, &status);
    if (result == EXIT_TROUBLE)
        fprintf(stderr, "sortlast compare: %s\n", status.message);
    image_difference_finish(&difference);
    image_destroy(images[0]);
    image_destroy(images[1]);
    return result;
}
