/* SPDX-License-Identifier: Apache-2.0 */
#include "tests/scenes/scene_test.h"

#include "base/rng.h"

#include <stdio.h>

/* Broken copies of a good file end in a frame or a message, never in a crash or a hang. The seed is
 * the first argument, the number of copies the second. */

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

static const char *const good =
    "##RenderMan RIB\nversion 3.03\nDeclare \"w\" \"varying float[2]\"\nFormat 64 48 1\n"
    "Projection \"perspective\" \"fov\" [45]\nClipping 0.1 100\nFrameBegin 1\nTranslate 0 0 5\n"
    "LightSource \"distantlight\" 1 \"intensity\" [0.8]\nObjectBegin 3\nSphere 0.5 -0.5 0.5 "
    "360\nObjectEnd\n"
    "WorldBegin\nAttributeBegin\nColor [1 0.5 0.25]\nSurface \"plastic\" \"Kd\" 0.5 \"uniform "
    "string n\" \"a\\n\"\n"
    "Rotate 30 1 1 0\nScale 1 -1 1\nTorus 1 .3 0 360 270 \"Cs\" [1 0 0 0 1 0 0 0 1 1 1 "
    "1]\nIlluminate 1 0\n"
    "AttributeEnd\nObjectInstance 3\nCone 1 .5 360\nDisk .1 1 360\nParaboloid 1 0 1 180\nCylinder "
    "1 -1 1 360\n"
    "Hyperboloid 1 0 -1 .5 .8 1 360\nBasis \"b-spline\" 1 \"bezier\" 3\n"
    "PatchMesh \"bicubic\" 5 \"periodic\" 4 \"nonperiodic\" \"P\" [0 0 0 1 0 0 2 0 1 1 0 2 0 0 1 0 "
    "1 0 1 1 0 2 1 1 1 1 2"
    " 0 1 1 0 2 0 1 2 0 2 2 1 1 2 2 0 2 1 0 3 0 1 3 0 2 3 1 1 3 2 0 3 1]\n"
    "Patch \"bilinear\" \"P\" [0 0 0 1 0 0 0 1 0 1 1 1]\n"
    "PointsGeneralPolygons [2 1] [4 3 3] [0 1 2 3 4 5 6 0 1 4] \"P\" [0 0 0 3 0 0 3 3 0 0 3 0 1 1 "
    "0 2 1 0 2 2 0]"
    " \"w\" [0 0 1 1 2 2 3 3 4 4 5 5 6 6] \"uniform color c\" [1 0 0 0 1 0]\n"
    "MotionBegin [0 1]\nTranslate 1 0 0\nTranslate 2 0 0\nMotionEnd\nPolygon \"P\" [0 0 0 1 0 0 1 "
    "1 0 .2 .1 0]\n"
    "WorldEnd\nFrameEnd\n";

static size_t mutate(struct rng *rng, char *text, size_t length, size_t capacity) {
    static const char *const pieces[] = {"1e30",  "-1",  "0",    "1e-30", "\"",  "[",
                                         "]",     "nan", "9e99", "#\n",   "360", "\\",
                                         "65536", "1e9", "-0",   "\"P\""};
    size_t changes = 1 + rng_below(rng, 4);
    for (size_t i = 0; i < changes && length > 8; i++) {
        size_t at = rng_below(rng, length), count = 1 + rng_below(rng, 12);
        if (count > length - at)
            count = length - at;
        switch (rng_below(rng, 5)) {
        case 0: /* a byte */
            text[at] = (char)rng_next(rng);
            break;
        case 1: /* leave out */
            memmove(text + at, text + at + count, length - at - count);
            length -= count;
            break;
        case 2: /* cut off */
            if (rng_below(rng, 4) == 0)
                length = at;
            break;
        case 3: { /* put in */
            const char *piece = pieces[rng_below(rng, sizeof pieces / sizeof *pieces)];
            size_t size = strlen(piece);
            if (length + size + 2 < capacity) {
                memmove(text + at + size + 2, text + at, length - at);
                memcpy(text + at + 1, piece, size);
                text[at] = text[at + size + 1] = ' ';
                length += size + 2;
            }
            break;
        }
        default: /* copy within */
            memmove(text + rng_below(rng, length - count + 1), text + at, count);
            break;
        }
    }
    return length;
}

static uint64_t seed = 1, copies = 4000;

static void mutated_files_never_crash(void **state) {
    struct rng rng = {seed};
    size_t capacity = strlen(good) + 1024;
    char *text = malloc(capacity);
    struct reading reading;
    struct scene_frame *frame = read_frame(&reading, good, NULL); /* the original is good */
    assert_int_equal(frame->mesh_count, 11);
    frame_close(&reading, frame);
    for (uint64_t i = 0; i < copies; i++) {
        memcpy(text, good, strlen(good));
        size_t length = mutate(&rng, text, strlen(good), capacity);
        LLVMFuzzerTestOneInput((const uint8_t *)text, length);
    }
    free(text);
}

static void every_prefix_ends_in_a_frame_or_a_message(void **state) {
    for (size_t length = 0; length <= strlen(good); length++)
        LLVMFuzzerTestOneInput((const uint8_t *)good, length);
}

int main(int count, char **arguments) {
    if (count > 1)
        seed = strtoull(arguments[1], NULL, 10);
    if (count > 2)
        copies = strtoull(arguments[2], NULL, 10);
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(mutated_files_never_crash),
        cmocka_unit_test(every_prefix_ends_in_a_frame_or_a_message),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
