/* SPDX-License-Identifier: Apache-2.0 */
#ifndef PROGRAM_SIGNALS_H
#define PROGRAM_SIGNALS_H

#include <signal.h>

/* SIGINT, SIGTERM and SIGHUP ask to leave; SIGUSR1 asks what the program waits for; SIGPIPE and SIGXFSZ become
 * errors of the call. */
extern volatile sig_atomic_t program_stop;     /* number of the signal, 0: none */
extern volatile sig_atomic_t program_describe;
void program_signals_install(void);

#endif
