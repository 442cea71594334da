/* SPDX-License-Identifier: Apache-2.0 */
#ifndef PROGRAM_PROCESS_H
#define PROGRAM_PROCESS_H

#include <signal.h>

/* SIGINT, SIGTERM and SIGHUP ask to leave; SIGUSR1 asks what the program waits for; SIGPIPE and SIGXFSZ become
 * errors of the call. */
extern volatile sig_atomic_t program_stop;     /* number of the signal, 0: none */
extern volatile sig_atomic_t program_describe;
void program_signals_install(void);

/* Lets the allocator keep the memory of region messages instead of giving it back to the system and fetching it
 * again, page fault by page fault, for every region. */
void program_memory_keep(void);

#endif
