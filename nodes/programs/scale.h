/* SPDX-License-Identifier: Apache-2.0 */
#ifndef SCALE_H
#define SCALE_H

#include "netsim/what_if.h"

#include <stdio.h>

/* `sortlast scale`: how frames get faster with more nodes, predicted and run. */
int scale_main(int argc, char **argv);

/* One cluster of a scaling study. */
struct scale_point {
    uint32_t rendering_nodes, shading_nodes;
    /* predicted */
    ticks time; /* of all frames */
    uint64_t ticks_per_s, regions;
    double busy[TIMING_RESOURCE_COUNT]; /* share of the time; raster and shading: of the busiest
                                           node */
    enum timing_resource bound_by;
    /* run live, when has_live */
    bool has_live;
    ticks live_time;
    double live_wall_s;
    /* against the least numbers of nodes of the study */
    double speed_up;   /* work done in the same time: for a grown scene more than time alone */
    double efficiency; /* of shading nodes: against the same rendering nodes and fewest shading */
};

struct scale_study {
    const char *scene, *machine, *strategy;
    bool is_weak;               /* the picture grows with the shading nodes */
    struct scale_point *points; /* [rendering * shading_count + shading] */
    size_t rendering_count, shading_count;
    uint32_t frame_count;
};

/* Fills in speed-up and efficiency of all points. */
void scale_compare(struct scale_study *study);
/* The fewest shading nodes (of those in the study) with which something else than shading bounds
 * the frame; 0: with none. */
uint32_t scale_crossover(const struct scale_study *study, size_t rendering);

void scale_print(FILE *stream, const struct scale_study *study);
bool scale_write_csv(const char *path, const struct scale_study *study, struct status *status);
bool scale_write_json(const char *path, const struct scale_study *study, struct status *status);
/* PREFIX.dat and PREFIX.gp, and PREFIX.svg when gnuplot is there; *is_drawn says so. */
bool scale_plot(const char *prefix, const struct scale_study *study, bool *is_drawn,
                struct status *status);

/* Live runs that are done, kept in a file so that a study can be interrupted and gone on with. */
struct scale_state;
/* `identity`: everything the results depend on but the numbers of nodes. A file of another study is
 * refused. path NULL: nothing is kept. */
bool scale_state_open(const char *path, const char *identity, struct scale_state **state,
                      struct status *status);
void scale_state_close(struct scale_state *state);
/* Fills in the live part of the point when it was run before. */
bool scale_state_find(const struct scale_state *state, struct scale_point *point);
bool scale_state_add(struct scale_state *state, const struct scale_point *point,
                     struct status *status);

#endif
