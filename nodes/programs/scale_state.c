/* SPDX-License-Identifier: Apache-2.0 */
#include "nodes/programs/scale.h"

#include <errno.h>
#include <inttypes.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static const char first_line[] = "sortlast scale, finished runs: ";

struct finished {
    uint32_t rendering_nodes, shading_nodes;
    int64_t time;
    double wall_s;
};

struct scale_state {
    FILE *file;
    struct finished *finished;
    size_t count, capacity;
};

static void add(struct scale_state *state, struct finished finished) {
    state->finished =
        memory_grow(state->finished, &state->capacity, state->count + 1, sizeof *state->finished);
    state->finished[state->count++] = finished;
}

/* Takes over what a file says; where its last line was cut off is where writing goes on. */
static bool read_finished(struct scale_state *state, const char *path, const char *identity,
                          struct status *status) {
    char *line = NULL;
    size_t capacity = 0;
    long good = 0;
    bool ok = true, is_first = true;
    for (ssize_t length; ok && (length = getline(&line, &capacity, state->file)) > 0;) {
        struct finished f;
        if (line[length - 1] != '\n')
            break;
        line[length - 1] = 0;
        if (is_first)
            ok = !strncmp(line, first_line, sizeof first_line - 1) &&
                 !strcmp(line + sizeof first_line - 1, identity);
        else if (sscanf(line, "%" SCNu32 " %" SCNu32 " %" SCNd64 " %lf", &f.rendering_nodes,
                        &f.shading_nodes, &f.time, &f.wall_s) != 4)
            break;
        else
            add(state, f);
        is_first = false;
        good = ftell(state->file);
    }
    free(line);
    if (!ok)
        return status_fail(status, STATUS_INVALID,
                           "%s is not the state of this study: of another scene, machine or "
                           "options; give another file, or remove it",
                           path);
    if (fseek(state->file, good, SEEK_SET) || ftruncate(fileno(state->file), good))
        return status_fail(status, STATUS_IO, "cannot write %s: %s", path, strerror(errno));
    if (is_first)
        fprintf(state->file, "%s%s\n", first_line, identity);
    return !fflush(state->file) ||
           status_fail(status, STATUS_IO, "cannot write %s: %s", path, strerror(errno));
}

bool scale_state_open(const char *path, const char *identity, struct scale_state **state,
                      struct status *status) {
    *state = memory_get(1, sizeof **state);
    if (!path)
        return true;
    (*state)->file = fopen(path, "r+");
    if (!(*state)->file && errno == ENOENT)
        (*state)->file = fopen(path, "w+");
    if ((*state)->file && read_finished(*state, path, identity, status))
        return true;
    if (!(*state)->file)
        status_fail(status, STATUS_IO, "cannot open %s: %s", path, strerror(errno));
    scale_state_close(*state);
    *state = NULL;
    return false;
}

void scale_state_close(struct scale_state *state) {
    if (!state)
        return;
    if (state->file)
        fclose(state->file);
    free(state->finished);
    free(state);
}

bool scale_state_find(const struct scale_state *state, struct scale_point *point) {
    for (size_t i = 0; i < state->count; i++) {
        const struct finished *f = &state->finished[i];
        if (f->rendering_nodes != point->rendering_nodes ||
            f->shading_nodes != point->shading_nodes)
            continue;
        point->has_live = true;
        point->live_time = f->time;
        point->live_wall_s = f->wall_s;
        return true;
    }
    return false;
}

bool scale_state_add(struct scale_state *state, const struct scale_point *point,
                     struct status *status) {
    add(state, (struct finished){point->rendering_nodes, point->shading_nodes, point->live_time,
                                 point->live_wall_s});
    if (!state->file)
        return true;
    fprintf(state->file, "%" PRIu32 " %" PRIu32 " %" PRId64 " %.17g\n", point->rendering_nodes,
            point->shading_nodes, point->live_time, point->live_wall_s);
    return !fflush(state->file) ||
           status_fail(status, STATUS_IO, "cannot keep a finished run: %s", strerror(errno));
}
