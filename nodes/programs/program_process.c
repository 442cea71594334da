/* SPDX-License-Identifier: Apache-2.0 */
#include "nodes/programs/program_process.h"

#include <errno.h>
#include <fcntl.h>
#include <malloc.h>
#include <stddef.h>
#include <stdio.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

volatile sig_atomic_t program_stop;
volatile sig_atomic_t program_describe;

static void ask_to_stop(int number) {
    program_stop = number;
}

static void ask_to_describe(int number) {
    program_describe = number;
}

static const int stops[] = {SIGINT, SIGTERM, SIGHUP};

void program_signals_reset(void) {
    for (size_t i = 0; i < sizeof stops / sizeof *stops; i++)
        signal(stops[i], SIG_DFL);
    signal(SIGUSR1, SIG_DFL);
}

void program_signals_install(void) {
    for (size_t i = 0; i < sizeof stops / sizeof *stops; i++)
        sigaction(stops[i], &(struct sigaction){.sa_handler = ask_to_stop}, NULL);
    sigaction(SIGUSR1, &(struct sigaction){.sa_handler = ask_to_describe}, NULL);
    /* a supervisor may have held back the one that says it is gone */
    sigset_t held;
    sigemptyset(&held);
    sigaddset(&held, SIGTERM);
    sigprocmask(SIG_UNBLOCK, &held, NULL);
    signal(SIGPIPE, SIG_IGN);
    signal(SIGXFSZ, SIG_IGN);
}

void program_streams_ensure(void) {
    int descriptor;
    while ((descriptor = open("/dev/null", O_RDWR)) >= 0 && descriptor <= STDERR_FILENO)
        ;
    if (descriptor > STDERR_FILENO)
        close(descriptor);
}

void program_files_raise(void) {
    struct rlimit limit;
    if (!getrlimit(RLIMIT_NOFILE, &limit) && limit.rlim_cur < limit.rlim_max) {
        limit.rlim_cur = limit.rlim_max;
        setrlimit(RLIMIT_NOFILE, &limit);
    }
}

long program_files_max(void) {
    struct rlimit limit;
    return getrlimit(RLIMIT_NOFILE, &limit) || limit.rlim_cur > 1L << 30 ? 1L << 30
                                                                         : (long)limit.rlim_cur;
}

void program_memory_keep(void) {
    enum { LARGEST_KEPT = 32 << 20, MOST_UNUSED = 256 << 20 };
    mallopt(M_MMAP_THRESHOLD, LARGEST_KEPT);
    mallopt(M_TRIM_THRESHOLD, MOST_UNUSED);
    mallopt(M_ARENA_MAX, 2);
}

char *program_output(char **arguments, int *exit_status) {
    int ends[2];
    char *text = NULL;
    size_t size = 0;
    if (pipe(ends))
        return NULL;
    fflush(NULL);
    const pid_t child = fork();
    if (!child) {
        dup2(ends[1], STDOUT_FILENO);
        close(ends[0]);
        close(ends[1]);
        program_signals_reset();
        execv("/proc/self/exe", arguments);
        _exit(2);
    }
    close(ends[1]);
    FILE *stream = open_memstream(&text, &size);
    char block[4096];
    for (ssize_t got;
         (got = read(ends[0], block, sizeof block)) > 0 || (got < 0 && errno == EINTR);)
        if (got > 0)
            fwrite(block, 1, (size_t)got, stream);
    fclose(stream);
    close(ends[0]);
    int result = -1;
    while (child > 0 && waitpid(child, &result, 0) < 0 && errno == EINTR)
        ;
    *exit_status = WIFEXITED(result) ? WEXITSTATUS(result) : 3;
    return text;
}
