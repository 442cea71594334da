/* SPDX-License-Identifier: Apache-2.0 */
#include "nodes/programs/program_process.h"

#include <malloc.h>
#include <stddef.h>

volatile sig_atomic_t program_stop;
volatile sig_atomic_t program_describe;

static void ask_to_stop(int number) {
    program_stop = number;
}

static void ask_to_describe(int number) {
    program_describe = number;
}

void program_signals_install(void) {
    const int stops[] = {SIGINT, SIGTERM, SIGHUP};
    for (size_t i = 0; i < sizeof stops / sizeof *stops; i++)
        sigaction(stops[i], &(struct sigaction){.sa_handler = ask_to_stop}, NULL);
    sigaction(SIGUSR1, &(struct sigaction){.sa_handler = ask_to_describe}, NULL);
    signal(SIGPIPE, SIG_IGN);
    signal(SIGXFSZ, SIG_IGN);
}

void program_memory_keep(void) {
    enum { LARGEST_KEPT = 32 << 20, MOST_UNUSED = 256 << 20 };
    mallopt(M_MMAP_THRESHOLD, LARGEST_KEPT);
    mallopt(M_TRIM_THRESHOLD, MOST_UNUSED);
    mallopt(M_ARENA_MAX, 2);
}
