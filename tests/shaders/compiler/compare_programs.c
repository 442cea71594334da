/* SPDX-License-Identifier: Apache-2.0 */
/* Compares random programs, compiled and by the reference evaluator: the command behind
 * "N programs, N differences". Each bundle of programs runs in a process of its own, so that a
 * crash is a difference like any other. */
#include "program_comparison.h"

#include <getopt.h>
#include <malloc.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

enum { JOBS_MAX = 64, PROGRESS_S = 10 };

static const char usage[] =
    "usage: compare_programs [--count N] [--seed S] [--jobs J]\n"
    "Compares N random programs (100000), of seeds S (1) and on, J bundles at a time (1): the\n"
    "colors of 16 samples, compiled and by an evaluator that walks the syntax tree, to the bit.\n"
    "Prints what differs, reduced, and at the end \"N programs, N differences\".\n"
    "Exit status: 0 no difference, 1 some, 2 wrong usage.\n";

struct options {
    unsigned long long count, seed;
    long jobs;
};

/* A bundle under way. */
struct job {
    pid_t pid;  /* 0: none */
    int result; /* to read the number of differences from */
    uint64_t first;
    int count;
};

struct totals {
    unsigned long long programs, differences;
    double begin, shown;
};

static double now_s(void) {
    struct timespec now;
    clock_gettime(CLOCK_MONOTONIC, &now);
    return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

/* In a process of its own: says what differs, and hands back how many programs do. */
static _Noreturn void run_bundle(uint64_t first, int count, int out) {
    struct comparison_result result;
    const struct bundle_settings *settings = comparison_settings_of(first);
    if (!comparison_run(first, count, settings, &result)) {
        char *report = comparison_report(first, settings, &result);
        puts(report);
        free(report);
        fflush(stdout);
    }
    const bool is_told = write(out, &result.differences, sizeof result.differences) ==
                         (ssize_t)sizeof result.differences;
    _exit(is_told ? 0 : 1);
}

static bool start(struct job *job, uint64_t first, int count) {
    int ends[2];
    fflush(stdout);
    if (pipe(ends))
        return false;
    *job = (struct job){.first = first, .count = count, .result = ends[0]};
    job->pid = fork();
    if (job->pid == 0)
        run_bundle(first, count, ends[1]);
    close(ends[1]);
    return job->pid > 0;
}

static void finish(struct job *job, int status, struct totals *totals) {
    int differences = 0;
    const bool is_whole =
        read(job->result, &differences, sizeof differences) == (ssize_t)sizeof differences;
    if (!is_whole || !WIFEXITED(status) || WEXITSTATUS(status)) {
        printf("the %d programs from %llu: the process ended early (%s %d)\n", job->count,
               (unsigned long long)job->first, WIFSIGNALED(status) ? "signal" : "status",
               WIFSIGNALED(status) ? WTERMSIG(status) : WEXITSTATUS(status));
        differences = job->count;
    }
    totals->programs += (unsigned long long)job->count;
    totals->differences += (unsigned long long)differences;
    close(job->result);
    job->pid = 0;
}

static void show(const struct options *o, struct totals *totals) {
    const double now = now_s(), rate = (double)totals->programs / (now - totals->begin);
    if (now < totals->shown + PROGRESS_S || !totals->programs)
        return;
    totals->shown = now;
    fprintf(stderr, "%llu of %llu programs, %llu differences; %.1f a second, %.0f min left\n",
            totals->programs, o->count, totals->differences, rate,
            (double)(o->count - totals->programs) / rate / 60);
}

/* The part of a bundle that begins at this seed: bundles begin at multiples. */
static int bundle_size(const struct options *o, uint64_t first) {
    const unsigned long long in_bundle = COMPARISON_BUNDLE - first % COMPARISON_BUNDLE,
                             left = o->seed + o->count - first;
    return (int)(in_bundle < left ? in_bundle : left);
}

static bool run(const struct options *o, struct totals *totals) {
    struct job jobs[JOBS_MAX] = {{0}};
    const uint64_t end = o->seed + o->count;
    uint64_t next = o->seed;
    for (;;) {
        int under_way = 0, status;
        for (long j = 0; j < o->jobs; j++) {
            if (!jobs[j].pid && next < end) {
                const int count = bundle_size(o, next);
                if (!start(&jobs[j], next, count))
                    return false;
                next += (uint64_t)count;
            }
            under_way += jobs[j].pid != 0;
        }
        if (!under_way)
            return true;
        const pid_t ended = wait(&status);
        for (long j = 0; j < o->jobs; j++)
            if (ended > 0 && jobs[j].pid == ended)
                finish(&jobs[j], status, totals);
        show(o, totals);
    }
}

static bool whole_number(const char *text, unsigned long long *number) {
    char *end;
    *number = strtoull(text, &end, 10);
    return text[0] >= '0' && text[0] <= '9' && !*end;
}

static bool parse(struct options *o, int count, char **words) {
    static const struct option names[] = {{"count", required_argument, NULL, 'c'},
                                          {"seed", required_argument, NULL, 's'},
                                          {"jobs", required_argument, NULL, 'j'},
                                          {"help", no_argument, NULL, 'h'},
                                          {0}};
    unsigned long long jobs = 1;
    int option;
    *o = (struct options){.count = 100000, .seed = 1};
    while ((option = getopt_long(count, words, "", names, NULL)) != -1) {
        bool ok = option != '?';
        if (option == 'h') {
            fputs(usage, stdout);
            exit(0);
        }
        if (ok)
            ok = whole_number(optarg, option == 'c' ? &o->count : option == 's' ? &o->seed : &jobs);
        if (!ok)
            return false;
    }
    o->jobs = (long)jobs;
    return optind == count && jobs >= 1 && jobs <= JOBS_MAX && o->count <= 1ull << 40 &&
           o->seed <= 1ull << 60;
}

int main(int count, char **words) {
    struct options o;
    if (!parse(&o, count, words)) {
        fputs(usage, stderr);
        return 2;
    }
    mallopt(M_MMAP_THRESHOLD, 1 << 28); /* memory of one program serves the next */
    mallopt(M_TRIM_THRESHOLD, 1 << 28);
    struct totals totals = {.begin = now_s(), .shown = now_s()};
    if (!run(&o, &totals)) {
        perror("compare_programs");
        return 1;
    }
    printf("%llu programs, %llu differences\n", totals.programs, totals.differences);
    return totals.differences ? 1 : 0;
}
