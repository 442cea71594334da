/* SPDX-License-Identifier: Apache-2.0 */
/* The timing model beside SimGrid, a simulator of distributed platforms by other people: the same
 * nodes, transfers and links. Here every node is a few actors that do one thing after the other and
 * know nothing of the recurrence: they raster, send, receive, shade, wait for buffers; SimGrid's
 * fluid network model decides how long transfers take. Latencies of the network are waited for by
 * the receiver, since SimGrid's own would also hold the sender. Agreement within 0.1 % is asked
 * for.
 *
 * Usage: simgrid_check [CASES]   (30; the suite asks for 6) */

#include "base/rng.h"
#include "netsim/timing.h"

#include <math.h>
#include <simgrid/actor.h>
#include <simgrid/engine.h>
#include <simgrid/host.h>
#include <simgrid/mailbox.h>
#include <simgrid/semaphore.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

enum { FRAMES = 2, REGIONS = 6, ALL = FRAMES * REGIONS, NODES = 6, SHADING = 4, MOVES = 64 };

/* One case, for all actors. */
static struct {
    struct machine machine;
    const struct strategy *strategy;
    struct schedule *schedule; /* NULL: chain */
    uint32_t r, s;
    struct timing_region regions[FRAMES][REGIONS];
    struct timing_work work[FRAMES][REGIONS][NODES];
    uint64_t geometry_bytes[FRAMES];
    /* by number of the region through all frames */
    sg_sem_t rastered[ALL][NODES], received[ALL][NODES], raster_buffer[NODES],
        shading_buffer[SHADING];
    sg_sem_t arrived[ALL], shaded[ALL];
    double receipt[ALL][NODES][MOVES], arrival[ALL], shaded_at[ALL], end[FRAMES];
} c;

static double seconds(ticks time) {
    return (double)time / (double)c.machine.rate.per_s;
}

static double geometry_end(int frame) {
    double end = 0;
    for (int f = 0; f <= frame; f++)
        end += seconds(
            ticks_multiply(c.machine.geometry_word, (int64_t)((c.geometry_bytes[f] + 3) / 4)));
    return end;
}

static struct timing_region *region_of(int n) {
    return &c.regions[n / REGIONS][n % REGIONS];
}

static const struct timing_work *work_of(int n, uint32_t node) {
    const struct timing_region *region = region_of(n);
    for (uint32_t w = 0; w < region->work_count; w++)
        if (region->work[w].node == node)
            return &region->work[w];
    return NULL;
}

static sg_mailbox_t mailbox(int n, uint32_t from, uint32_t to) {
    char name[64];
    snprintf(name, sizeof name, "%d-%u-%u", n, from, to);
    return sg_mailbox_by_name(name);
}

static double bytes_of(int n, uint32_t samples) {
    const double words = (double)samples * region_of(n)->words;
    return (words > 0 ? words : 1) * (double)c.machine.composition_word_bytes;
}

static void wait_until(double time) {
    if (time > simgrid_get_clock())
        sg_actor_sleep_until(time);
}

static void end_of(int n, double time) {
    double *end = &c.end[n / REGIONS];
    *end = time > *end ? time : *end;
}

static void raster(int argc, char **argv) {
    const uint32_t i = (uint32_t)atoi(argv[1]);
    for (int n = 0; n < ALL; n++) {
        const struct timing_work *work = work_of(n, i);
        wait_until(geometry_end(n / REGIONS));
        if (work) {
            sg_sem_acquire(c.raster_buffer[i]);
            sg_actor_sleep_for(
                seconds(c.machine.raster_region + c.machine.raster_triangle * work->triangles));
        }
        sg_sem_release(c.rastered[n][i]);
    }
}

/* The whole chain sends at once: one actor stands for it. */
static void chain_send(int argc, char **argv) {
    for (int n = 0; n < ALL; n++) {
        const uint32_t j = (uint32_t)(n % REGIONS) % c.s;
        for (uint32_t i = 0; i < c.r; i++)
            sg_sem_acquire(c.rastered[n][i]);
        if (region_of(n)->words)
            sg_sem_acquire(c.shading_buffer[j]);
        sg_mailbox_put(mailbox(n, 0, NODES + j), &c,
                       (long)bytes_of(n, region_of(n)->words ? 8192 : 0));
        for (uint32_t i = 0; i < c.r; i++)
            if (work_of(n, i))
                sg_sem_release(c.raster_buffer[i]);
    }
}

/* Waits for all that rank receives before a step: `taken` of it were waited for already. */
static void await_parts(int n, uint32_t i, uint32_t rank, uint32_t step, uint32_t *taken) {
    const struct schedule *schedule = c.schedule;
    for (size_t m = schedule->receive_begin[rank] + *taken; m < schedule->receive_begin[rank + 1];
         m++) {
        if (schedule->moves[schedule->receives[m]].step >= step)
            return;
        sg_sem_acquire(c.received[n][i]);
        wait_until(c.receipt[n][i][(*taken)++] + seconds(c.machine.composition_hop));
    }
}

static void node_send(int argc, char **argv) {
    const struct schedule *schedule = c.schedule;
    const uint32_t i = (uint32_t)atoi(argv[1]);
    for (int n = 0; n < ALL; n++) {
        const uint32_t k = (uint32_t)(n % REGIONS), rank = schedule_rank(schedule, i, k);
        uint32_t taken = 0;
        sg_sem_acquire(c.rastered[n][i]);
        for (size_t m = schedule->send_begin[rank]; m < schedule->send_begin[rank + 1]; m++) {
            const struct schedule_move *move = &schedule->moves[schedule->sends[m]];
            const uint32_t to = move->to == SCHEDULE_SHADING ? NODES + k % c.s
                                                             : schedule_node(schedule, move->to, k);
            await_parts(n, i, rank, move->step, &taken);
            sg_mailbox_put(mailbox(n, i, to), &c, (long)bytes_of(n, move->end - move->first));
        }
        if (work_of(n, i))
            sg_sem_release(c.raster_buffer[i]);
    }
}

static void node_receive(int argc, char **argv) {
    const struct schedule *schedule = c.schedule;
    const uint32_t i = (uint32_t)atoi(argv[1]);
    for (int n = 0; n < ALL; n++) {
        const uint32_t k = (uint32_t)(n % REGIONS), rank = schedule_rank(schedule, i, k);
        const size_t begin = schedule->receive_begin[rank];
        for (size_t m = begin; m < schedule->receive_begin[rank + 1]; m++) {
            const uint32_t from =
                schedule_node(schedule, schedule->moves[schedule->receives[m]].from, k);
            sg_mailbox_get(mailbox(n, from, i));
            c.receipt[n][i][m - begin] = simgrid_get_clock();
            sg_sem_release(c.received[n][i]);
        }
    }
}

/* Takes whole regions in; from a switched network in parts. */
static void shading_receive(int argc, char **argv) {
    const uint32_t j = (uint32_t)atoi(argv[1]);
    const double way = seconds(c.machine.composition_hop) * (c.schedule ? 1 : c.r + j);
    for (int n = 0; n < ALL; n++) {
        const uint32_t k = (uint32_t)(n % REGIONS);
        if (k % c.s != j)
            continue;
        if (c.schedule && region_of(n)->words) {
            sg_sem_acquire(c.shading_buffer[j]);
        }
        if (!c.schedule)
            sg_mailbox_get(mailbox(n, 0, NODES + j));
        for (size_t m = 0; c.schedule && m < c.schedule->count; m++)
            if (c.schedule->moves[m].to == SCHEDULE_SHADING)
                sg_mailbox_get(
                    mailbox(n, schedule_node(c.schedule, c.schedule->moves[m].from, k), NODES + j));
        c.arrival[n] = simgrid_get_clock() + way;
        sg_sem_release(c.arrived[n]);
    }
}

static void shade(int argc, char **argv) {
    const uint32_t j = (uint32_t)atoi(argv[1]);
    const double way = seconds(c.machine.composition_hop) * (c.schedule ? 1 : c.s - j);
    for (int n = 0; n < ALL; n++) {
        if ((uint32_t)(n % REGIONS) % c.s != j)
            continue;
        sg_sem_acquire(c.arrived[n]);
        if (!region_of(n)->words) {
            end_of(n, c.arrival[n] + way);
            continue;
        }
        wait_until(c.arrival[n]);
        sg_actor_sleep_for(seconds(region_of(n)->shading));
        c.shaded_at[n] = simgrid_get_clock() + way;
        sg_sem_release(c.shaded[n]);
    }
}

static void take_colours(int argc, char **argv) {
    const double colours = seconds(c.machine.composition_word * 8192 * c.machine.colour_words);
    for (int n = 0; n < ALL; n++) {
        if (!region_of(n)->words)
            continue;
        sg_sem_acquire(c.shaded[n]);
        wait_until(c.shaded_at[n]);
        sg_actor_sleep_for(colours);
        end_of(n, simgrid_get_clock());
        sg_sem_release(c.shading_buffer[(uint32_t)(n % REGIONS) % c.s]);
    }
}

static void random_case(struct rng *rng) {
    c.machine = (struct machine){.region_width = 128,
                                 .region_height = 64,
                                 .composition_word_bytes = 32,
                                 .geometry_word_bytes = 4,
                                 .geometry_frame_buffers = FRAMES,
                                 .rate = {1000000000}};
    c.machine.composition_word = 1 + (ticks)rng_below(rng, 5);
    c.machine.geometry_word = 1 + (ticks)rng_below(rng, 5);
    c.machine.raster_triangle = (ticks)rng_below(rng, 400);
    c.machine.raster_region = (ticks)rng_below(rng, 400);
    c.machine.colour_words = 1 + (int64_t)rng_below(rng, 2);
    c.machine.composition_region_buffers = 1 + (int64_t)rng_below(rng, 3);
    /* a buffer is known to be free a few hops later than the model counts: kept small */
    c.machine.composition_hop = (ticks)rng_below(rng, 3);
    c.r = 1 + (uint32_t)rng_below(rng, NODES);
    c.s = 1 + (uint32_t)rng_below(rng, SHADING);
    for (int n = 0; n < ALL; n++) {
        struct timing_region *region = region_of(n);
        struct timing_work *work = c.work[n / REGIONS][n % REGIONS];
        region->words = (uint32_t)rng_below(rng, 4);
        region->shading = region->words ? (ticks)rng_below(rng, 60000) : 0;
        for (uint32_t i = 0; i < c.r; i++)
            if (rng_below(rng, 2))
                work[region->work_count++] = (struct timing_work){i, (uint32_t)rng_below(rng, 200)};
        region->work = work;
    }
    for (int f = 0; f < FRAMES; f++)
        c.geometry_bytes[f] = rng_below(rng, 40000);
}

/* Hosts r0.. and s0.., a port of two directions each; for the chain, links from neighbour to
 * neighbour. */
static void write_platform(FILE *file) {
    const double rate =
        (double)c.machine.composition_word_bytes * 1e9 / (double)c.machine.composition_word;
    const uint32_t all = c.r + c.s;
    fprintf(file, "<?xml version='1.0'?>\n<!DOCTYPE platform SYSTEM "
                  "\"https://simgrid.org/simgrid.dtd\">\n<platform version=\"4.1\">\n<zone "
                  "id=\"z\" routing=\"Full\">\n");
    for (uint32_t x = 0; x < all; x++)
        fprintf(file, "<host id=\"h%u\" speed=\"1Gf\"/>\n", x);
    for (uint32_t x = 0; x < all; x++)
        fprintf(file,
                "<link id=\"out%u\" bandwidth=\"%.17gBps\" latency=\"0s\"/>\n<link id=\"in%u\" "
                "bandwidth=\"%.17gBps\" latency=\"0s\"/>\n",
                x, rate, x, rate);
    for (uint32_t a = 0; a < all; a++)
        for (uint32_t b = 0; b < all; b++) {
            if (a == b)
                continue;
            fprintf(file, "<route src=\"h%u\" dst=\"h%u\" symmetrical=\"NO\">", a, b);
            if (c.schedule || b < a)
                fprintf(file, "<link_ctn id=\"out%u\"/><link_ctn id=\"in%u\"/>", a, b);
            for (uint32_t x = a; !c.schedule && x < b; x++)
                fprintf(file, "<link_ctn id=\"out%u\"/>", x);
            fprintf(file, "</route>\n");
        }
    fprintf(file, "</zone>\n</platform>\n");
}

static void start(const char *name, uint32_t host, uint32_t index, void (*code)(int, char **)) {
    char host_name[16], number[16];
    char *arguments[] = {(char *)name, number, NULL};
    snprintf(host_name, sizeof host_name, "h%u", host);
    snprintf(number, sizeof number, "%u", index);
    sg_actor_create(name, sg_host_by_name(host_name), code, 2, arguments);
}

static void simulate(void) {
    char path[] = "/tmp/sortlast-platform-XXXXXX.xml";
    const int descriptor = mkstemps(path, 4);
    FILE *file = fdopen(descriptor, "w");
    write_platform(file);
    fclose(file);
    char *arguments[] = {"simgrid_check",
                         "--log=root.thresh:error",
                         "--cfg=network/model:CM02",
                         "--cfg=network/TCP-gamma:0",
                         "--cfg=network/weight-S:0",
                         "--cfg=network/crosstraffic:0",
                         NULL};
    int count = 6;
    simgrid_init(&count, arguments);
    simgrid_load_platform(path);
    unlink(path);
    const int buffers = (int)c.machine.composition_region_buffers;
    for (uint32_t i = 0; i < c.r; i++)
        c.raster_buffer[i] = sg_sem_init(buffers);
    for (uint32_t j = 0; j < c.s; j++)
        c.shading_buffer[j] = sg_sem_init(buffers);
    for (int n = 0; n < ALL; n++) {
        c.arrived[n] = sg_sem_init(0);
        c.shaded[n] = sg_sem_init(0);
        for (uint32_t i = 0; i < c.r; i++) {
            c.rastered[n][i] = sg_sem_init(0);
            c.received[n][i] = sg_sem_init(0);
        }
    }
    for (uint32_t i = 0; i < c.r; i++) {
        start("raster", i, i, raster);
        if (!c.schedule)
            continue;
        start("send", i, i, node_send);
        start("receive", i, i, node_receive);
    }
    if (!c.schedule)
        start("chain", 0, 0, chain_send);
    for (uint32_t j = 0; j < c.s; j++) {
        start("take", c.r + j, j, shading_receive);
        start("shade", c.r + j, j, shade);
    }
    start("colours", c.r, 0, take_colours);
    simgrid_run();
}

/* Runs one case in a process of its own, for SimGrid can be started once; returns the largest
 * difference, as a fraction of the end. */
static double run_case(uint64_t seed, const struct strategy *strategy) {
    struct rng rng = {seed};
    double worst = 0;
    random_case(&rng);
    c.strategy = strategy;
    c.schedule = strategy->plan ? schedule_create(strategy->plan, c.r, 8192) : NULL;
    simulate();
    struct timing_model *model = timing_model_create(&c.machine, strategy, c.r, c.s);
    double before = 0;
    for (int f = 0; f < FRAMES; f++) {
        struct timing_result result;
        const struct timing_frame frame = {c.geometry_bytes[f], c.regions[f], REGIONS, NULL};
        if (!timing_model_add_frame(model, &frame, &result, NULL))
            return 1;
        double end = c.end[f] > before ? c.end[f] : before;
        end = end > geometry_end(f) ? end : geometry_end(f);
        before = end;
        const double error = fabs(end / seconds(result.end) - 1);
        worst = error > worst ? error : worst;
    }
    timing_model_destroy(model);
    schedule_destroy(c.schedule);
    return worst;
}

int main(int argc, char **argv) {
    const int cases = argc > 1 ? atoi(argv[1]) : 30;
    const struct strategy *strategy;
    int failed = 0;
    for (int s = 0; (strategy = strategy_at(s)); s++) {
        double worst = 0;
        for (int i = 0; i < cases; i++) {
            int ends[2];
            double error = 1;
            if (pipe(ends))
                return 2;
            fflush(stdout);
            const pid_t child = fork();
            if (!child) {
                error = run_case((uint64_t)(1000 * s + i + 1), strategy);
                _exit(write(ends[1], &error, sizeof error) != sizeof error);
            }
            close(ends[1]);
            if (read(ends[0], &error, sizeof error) != sizeof error)
                error = 1;
            close(ends[0]);
            waitpid(child, NULL, 0);
            worst = error > worst ? error : worst;
        }
        printf("%-12s %d random clusters: SimGrid within %.6f %%\n", strategy->name, cases,
               100 * worst);
        failed |= !(worst <= 1e-3);
    }
    return failed;
}
