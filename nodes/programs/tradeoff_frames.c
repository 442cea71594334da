/* SPDX-License-Identifier: Apache-2.0 */
#include "nodes/programs/tradeoff.h"
#include "scenes/scene.h"

#include <stdlib.h>
#include <string.h>

/* Which frames a choice is tuned on, and on which unseen ones it is judged. */

enum { FRAME_NUMBER_MAX = 1000000 };

static bool add_frame(struct tradeoff_frames *frames, int number) {
    int at = frames->count;
    for (int i = 0; i < frames->count; i++)
        if (frames->numbers[i] == number)
            return true;
    if (frames->count == TRADEOFF_FRAMES_MAX)
        return false;
    for (; at && frames->numbers[at - 1] > number; at--)
        frames->numbers[at] = frames->numbers[at - 1];
    frames->numbers[at] = number;
    frames->count++;
    return true;
}

static bool parse_frames(const char *option, const char *text, struct tradeoff_frames *frames,
                         struct status *status) {
    *frames = (struct tradeoff_frames){.count = 0};
    for (const char *at = text;; at++) {
        char *end;
        const long first = strtol(at, &end, 10);
        long last = first;
        bool is_good = end != at;
        if (is_good && *end == '-') {
            at = end + 1;
            last = strtol(at, &end, 10);
            is_good = end != at;
        }
        if (!is_good || first < 1 || last < first || last > FRAME_NUMBER_MAX ||
            (*end && *end != ','))
            return status_fail(status, STATUS_INVALID,
                               "%s must be frames of the scene like 1,3-5, not \"%s\"", option,
                               text);
        for (long number = first; number <= last; number++)
            if (!add_frame(frames, (int)number))
                return status_fail(status, STATUS_INVALID, "%s: at most %d frames", option,
                                   TRADEOFF_FRAMES_MAX);
        if (!*end)
            return true;
        at = end;
    }
}

/* Frames of the scene, counted up to `most`. */
static bool count_frames(const char *scene, int most, int *count, struct status *status) {
    const struct scene_options reading = {0};
    struct rib_reader *reader;
    if (!rib_reader_open(scene, &reading, &reader, status))
        return false;
    bool ok = true;
    for (*count = 0; ok && *count < most; ++*count) {
        struct scene_frame *frame = NULL;
        ok = rib_reader_next(reader, &frame, status);
        if (!ok || !frame)
            break;
        scene_frame_destroy(frame);
    }
    rib_reader_destroy(reader);
    return ok;
}

static int last_of(const struct tradeoff_frames *frames) {
    return frames->count ? frames->numbers[frames->count - 1] : 0;
}

static bool contains(const struct tradeoff_frames *frames, int number) {
    for (int i = 0; i < frames->count; i++)
        if (frames->numbers[i] == number)
            return true;
    return false;
}

/* All frames but those tuned on; of more than TRADEOFF_JUDGED_MAX so many, evenly spread. */
static void take_others(struct tradeoff_study *study, int count) {
    struct tradeoff_frames others = {.count = 0};
    for (int number = 1; number <= count; number++)
        if (!contains(&study->tuned, number))
            add_frame(&others, number);
    const int wanted = others.count < TRADEOFF_JUDGED_MAX ? others.count : TRADEOFF_JUDGED_MAX;
    for (int i = 0; i < wanted; i++)
        add_frame(&study->unseen,
                  others.numbers[wanted == 1 ? 0 : i * (others.count - 1) / (wanted - 1)]);
}

bool tradeoff_choose_frames(const struct tradeoff_options *o, struct tradeoff_study *study,
                            struct status *status) {
    const bool judges_none = o->judge_frames && !strcmp(o->judge_frames, "none");
    if (!parse_frames("--tune-frames", o->tune_frames ? o->tune_frames : "1", &study->tuned,
                      status))
        return false;
    study->unseen.count = 0;
    if (o->judge_frames && !judges_none &&
        !parse_frames("--judge-frames", o->judge_frames, &study->unseen, status))
        return false;
    for (int i = 0; i < study->unseen.count; i++)
        if (contains(&study->tuned, study->unseen.numbers[i]))
            return status_fail(status, STATUS_INVALID,
                               "frame %d cannot be tuned on and judged: what is judged must not "
                               "have been seen",
                               study->unseen.numbers[i]);
    const int last_tuned = last_of(&study->tuned), last_judged = last_of(&study->unseen);
    const int last = last_tuned > last_judged ? last_tuned : last_judged;
    int count;
    if (!count_frames(o->scene,
                      o->judge_frames || last > TRADEOFF_FRAMES_MAX ? last : TRADEOFF_FRAMES_MAX,
                      &count, status))
        return false;
    if (count < last && count)
        return status_fail(status, STATUS_INVALID, "%s has %d frame%s, so there is no frame %d",
                           o->scene, count, count == 1 ? "" : "s", last);
    if (!o->judge_frames)
        take_others(study, count < TRADEOFF_FRAMES_MAX ? count : TRADEOFF_FRAMES_MAX);
    return true;
}

void tradeoff_describe_frames(const struct tradeoff_frames *frames, char *text, size_t size) {
    size_t used = 0;
    text[0] = 0;
    for (int i = 0; i < frames->count && used < size;) {
        int last = i;
        while (last + 1 < frames->count && frames->numbers[last + 1] == frames->numbers[last] + 1)
            last++;
        used +=
            (size_t)snprintf(text + used, size - used, "%s%d", used ? "," : "", frames->numbers[i]);
        if (last > i && used < size)
            used += (size_t)snprintf(text + used, size - used, "-%d", frames->numbers[last]);
        i = last + 1;
    }
}
