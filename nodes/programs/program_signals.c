/* SPDX-License-Identifier: Apache-2.0 */
#include "nodes/programs/program_signals.h"

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
