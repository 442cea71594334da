/* SPDX-License-Identifier: Apache-2.0 */
#ifndef PROGRAM_PROCESS_H
#define PROGRAM_PROCESS_H

#include <signal.h>

/* SIGINT, SIGTERM and SIGHUP ask to leave; SIGUSR1 asks what the program waits for; SIGPIPE and
 * SIGXFSZ become errors of the call. */
extern volatile sig_atomic_t program_stop; /* number of the signal, 0: none */
extern volatile sig_atomic_t program_describe;
void program_signals_install(void);
/* Back to what the system does by default. */
void program_signals_reset(void);

/* Standard streams that are closed are opened on /dev/null, so that no file of ours is taken for
 * one of them. */
void program_streams_ensure(void);
/* Takes all file descriptors the system allows: sockets of large clusters need them. */
void program_files_raise(void);
/* How many there may be. */
long program_files_max(void);

/* Lets the allocator keep the memory of region messages instead of giving it back to the system and
 * fetching it again, page fault by page fault, for every region. */
void program_memory_keep(void);

/* Runs this program with other arguments and waits; returns what it printed on standard output, the
 * caller's, NULL when it could not be started. */
char *program_output(char **arguments, int *exit_status);

#endif
