/* SPDX-License-Identifier: Apache-2.0 */
#include "nodes/programs/local_cluster.h"

#include "nodes/programs/program_process.h"
#include "nodes/shared_pool.h"
#include "nodes/status_board.h"

#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <netinet/in.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/prctl.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

enum {
    CAUSE_PATIENCE_MS = 1500, /* how long to wait for the cause when a node says it lost another */
    LEAVE_PATIENCE_MS =
        10000, /* how long nodes get to leave: finished frames are still being written */
    STOPPED_PATIENCE_MS = 500,
    POLL_MS = 5,
    ARGUMENTS_MAX = 24,
    LOCAL_NODES_MAX = 1024, /* processes that one machine may well be asked to start */
};

struct child {
    struct node_address address;
    pid_t pid; /* 0: gone */
    int result;
};

struct local_cluster {
    const struct render_options *options;
    struct child *children; /* the host first */
    uint32_t count;
    struct status_board_entry *board;
    int board_descriptor, pool_descriptor; /* the latter -1: no shared memory */
    char folder[4096];                     /* private, for the sockets */
    char endpoint[4200];                   /* of the host */
    char programs[3072];                   /* folder of the node programs */
};

static bool make_folder(struct local_cluster *cluster, struct status *status) {
    const char *base = getenv("TMPDIR");
    /* socket paths have at most 107 bytes */
    if (!base || !*base || strlen(base) > 60)
        base = "/tmp";
    snprintf(cluster->folder, sizeof cluster->folder, "%s/sortlast-XXXXXX", base);
    if (mkdtemp(cluster->folder))
        return true;
    cluster->folder[0] = 0;
    return status_fail(status, STATUS_IO, "cannot make a private folder for sockets in %s: %s",
                       base, strerror(errno));
}

static void remove_folder(const char *folder) {
    DIR *directory = folder[0] ? opendir(folder) : NULL;
    if (!directory)
        return;
    for (struct dirent *entry; (entry = readdir(directory));)
        if (strcmp(entry->d_name, ".") && strcmp(entry->d_name, ".."))
            unlinkat(dirfd(directory), entry->d_name, 0);
    closedir(directory);
    rmdir(folder);
}

/* A picture half written by a node that was killed: ".NAME.PID.tmp" in the folder of the output. */
static void remove_partial_pictures(const struct local_cluster *cluster, pid_t pid) {
    const char *output = cluster->options->host.output,
               *slash = output ? strrchr(output, '/') : NULL;
    char folder[4096], suffix[32];
    if (!output)
        return;
    snprintf(folder, sizeof folder, "%.*s", slash ? (int)(slash - output) : 1,
             slash ? output : ".");
    snprintf(suffix, sizeof suffix, ".%d.tmp", (int)pid);
    DIR *directory = opendir(slash == output ? "/" : folder);
    if (!directory)
        return;
    for (struct dirent *entry; (entry = readdir(directory));) {
        const size_t length = strlen(entry->d_name);
        if (entry->d_name[0] == '.' && length > strlen(suffix) &&
            !strcmp(entry->d_name + length - strlen(suffix), suffix))
            unlinkat(dirfd(directory), entry->d_name, 0);
    }
    closedir(directory);
}

/* A loopback port that is free now; the host reports if somebody else is quicker. */
static unsigned free_port(void) {
    struct sockaddr_in address = {.sin_family = AF_INET, .sin_addr.s_addr = htonl(INADDR_LOOPBACK)};
    socklen_t size = sizeof address;
    const int probe = socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
    if (probe < 0 || bind(probe, (struct sockaddr *)&address, sizeof address) ||
        getsockname(probe, (struct sockaddr *)&address, &size))
        address.sin_port = 0;
    if (probe >= 0)
        close(probe);
    return ntohs(address.sin_port);
}

static bool choose_endpoint(struct local_cluster *cluster, struct status *status) {
    if (cluster->options->transport == TRANSPORT_IPC) {
        if (!make_folder(cluster, status))
            return false;
        snprintf(cluster->endpoint, sizeof cluster->endpoint, "ipc://%s/host", cluster->folder);
        return true;
    }
    const unsigned port = free_port();
    snprintf(cluster->endpoint, sizeof cluster->endpoint, "tcp://127.0.0.1:%u", port);
    return port || status_fail(status, STATUS_IO, "no port of the loopback interface is free");
}

/* The child's side between fork and exec. */
static void become(const struct local_cluster *cluster, const char *const *arguments, pid_t parent,
                   const sigset_t *signals) {
    char path[4096];
    const bool is_host = !strcmp(arguments[0], node_role_program(NODE_HOST));
    sigset_t mask = *signals;
    program_signals_reset();
    /* The host removes the folder when the supervisor is killed: it must not end by that signal
     * before it can. It takes the signal as soon as it has a handler. */
    if (is_host)
        sigaddset(&mask, SIGTERM);
    sigprocmask(SIG_SETMASK, &mask, NULL); /* one that came meanwhile takes effect now */
    prctl(PR_SET_PDEATHSIG, SIGTERM);
    if (getppid() != parent) {
        if (is_host)
            remove_folder(cluster->folder);
        _exit(2);
    }
    setpgid(
        0,
        0); /* an interrupt from the terminal goes to the supervisor alone, which ends the rest */
    snprintf(path, sizeof path, "%s/%s", cluster->programs, arguments[0]);
    execv(path, (char *const *)arguments);
    fprintf(stderr, "sortlast: cannot start %s: %s\n", path, strerror(errno));
    _exit(2);
}

static bool start(struct local_cluster *cluster, struct child *child, const char *const *arguments,
                  struct status *status) {
    const pid_t parent = getpid();
    sigset_t all, before;
    fflush(NULL);
    /* until the child has put the handlers aside, a signal would only be noted, and forgotten by
     * exec */
    sigfillset(&all);
    sigprocmask(SIG_BLOCK, &all, &before);
    child->pid = fork();
    if (child->pid == 0)
        become(cluster, arguments, parent, &before);
    sigprocmask(SIG_SETMASK, &before, NULL);
    if (child->pid > 0)
        setpgid(child->pid, child->pid); /* as the child does itself: whoever is first */
    if (child->pid > 0)
        return true;
    child->pid = 0;
    return status_fail(status, STATUS_LIMIT, "cannot start another process: %s", strerror(errno));
}

static bool start_host(struct local_cluster *cluster, int argument_count, char **arguments,
                       struct status *status) {
    char board[32], supervisor[16];
    const char **list = memory_get((size_t)argument_count + 8, sizeof *list);
    int count = 0;
    snprintf(board, sizeof board, "%d", cluster->board_descriptor);
    snprintf(supervisor, sizeof supervisor, "%d", (int)getpid());
    list[count++] = node_role_program(NODE_HOST);
    for (int i = 1; i < argument_count; i++)
        list[count++] = arguments[i];
    list[count++] = "--bind";
    list[count++] = cluster->endpoint;
    list[count++] = "--status-board";
    list[count++] = board;
    list[count++] = "--supervisor";
    list[count++] = supervisor;
    cluster->children[0].address = (struct node_address){NODE_HOST, 0};
    bool ok = start(cluster, &cluster->children[0], list, status);
    free(list);
    return ok;
}

static bool start_node(struct local_cluster *cluster, uint32_t entry, struct node_address address,
                       struct status *status) {
    char index[16], board[48], pool[48], deadline[16], supervisor[16];
    snprintf(index, sizeof index, "%u", address.index);
    snprintf(board, sizeof board, "%d:%u", cluster->board_descriptor, entry);
    snprintf(deadline, sizeof deadline, "%d", cluster->options->deadline_s);
    snprintf(supervisor, sizeof supervisor, "%d", (int)getpid());
    const char *list[ARGUMENTS_MAX] = {node_role_program(address.role),
                                       "--host",
                                       cluster->endpoint,
                                       "--index",
                                       index,
                                       "--status-board",
                                       board,
                                       "--deadline",
                                       deadline,
                                       "--supervisor",
                                       supervisor};
    int count = 11;
    if (cluster->options->verbosity > 0)
        list[count++] = "--verbose";
    if (cluster->options->link && address.role == NODE_SHADING) {
        list[count++] = "--link";
        list[count++] = cluster->options->link;
    }
    if (cluster->pool_descriptor >= 0) {
        snprintf(pool, sizeof pool, "%d:%u", cluster->pool_descriptor, entry);
        list[count++] = "--shared-pool";
        list[count++] = pool;
    }
    cluster->children[entry].address = address;
    return start(cluster, &cluster->children[entry], list, status);
}

static bool start_all(struct local_cluster *cluster, int argument_count, char **arguments,
                      struct status *status) {
    const uint32_t r = cluster->options->host.rendering_nodes,
                   s = cluster->options->host.shading_nodes;
    cluster->count = r + s + 2;
    cluster->children = memory_get(cluster->count, sizeof *cluster->children);
    cluster->board_descriptor = status_board_create(cluster->count, &cluster->board);
    if (cluster->board_descriptor < 0)
        return status_fail(status, STATUS_IO, "cannot make shared memory: %s", strerror(errno));
    /* over tcp the nodes are to do as they would on several machines */
    if (cluster->options->transport == TRANSPORT_IPC)
        cluster->pool_descriptor = shared_pool_create(cluster->count);
    if (!program_folder(cluster->programs, sizeof cluster->programs))
        return status_fail(status, STATUS_NOT_FOUND, "cannot find the folder of the node programs");
    if (!choose_endpoint(cluster, status))
        return false;
    bool ok = start_host(cluster, argument_count, arguments, status);
    uint32_t entry = 1;
    for (uint32_t i = 0; ok && i < r; i++)
        ok = start_node(cluster, entry++, (struct node_address){NODE_RENDERING, i}, status);
    for (uint32_t i = 0; ok && i < s; i++)
        ok = start_node(cluster, entry++, (struct node_address){NODE_SHADING, i}, status);
    return ok && start_node(cluster, entry, (struct node_address){NODE_FRAMEBUFFER, 0}, status);
}

static void pause_ms(int ms) {
    nanosleep(&(struct timespec){ms / 1000, (ms % 1000) * 1000000L}, NULL);
}

/* The next child that has ended, NULL when none has. Only our own children are waited for. */
static struct child *reap(struct local_cluster *cluster) {
    for (uint32_t i = 0; i < cluster->count; i++) {
        struct child *child = &cluster->children[i];
        if (child->pid && waitpid(child->pid, &child->result, WNOHANG) == child->pid) {
            remove_partial_pictures(cluster, child->pid);
            child->pid = 0;
            return child;
        }
    }
    return NULL;
}

static bool any_left(const struct local_cluster *cluster) {
    for (uint32_t i = 0; i < cluster->count; i++)
        if (cluster->children[i].pid)
            return true;
    return false;
}

static void signal_all(const struct local_cluster *cluster, int number) {
    for (uint32_t i = 0; i < cluster->count; i++)
        if (cluster->children[i].pid)
            kill(-cluster->children[i].pid,
                 number); /* its group: a compiler may be running for it */
}

/* Asks all that are left to go, then makes them. */
static void end_all(struct local_cluster *cluster, bool are_leaving) {
    for (int waited = 0; are_leaving && any_left(cluster) && waited < LEAVE_PATIENCE_MS;
         waited += POLL_MS)
        if (!reap(cluster))
            pause_ms(POLL_MS);
    signal_all(cluster, SIGTERM);
    for (int waited = 0; any_left(cluster) && waited < LEAVE_PATIENCE_MS; waited += POLL_MS) {
        if (waited == STOPPED_PATIENCE_MS)
            signal_all(cluster, SIGCONT); /* a stopped process would not hear the other */
        if (!reap(cluster))
            pause_ms(POLL_MS);
    }
    signal_all(cluster, SIGKILL);
    while (any_left(cluster))
        if (!reap(cluster))
            pause_ms(POLL_MS);
}

static void report_loss(const struct local_cluster *cluster, const struct child *child) {
    const struct status_board_entry *entry = &cluster->board[child - cluster->children];
    char name[NODE_NAME_BYTES], place[NODE_PLACE_BYTES], how[64];
    if (WIFSIGNALED(child->result))
        snprintf(how, sizeof how, "was killed by signal %d (%s)", WTERMSIG(child->result),
                 strsignal(WTERMSIG(child->result)));
    else
        snprintf(how, sizeof how, "ended with status %d", WEXITSTATUS(child->result));
    fprintf(stderr, "sortlast: %s %s %s; finished frames are kept\n",
            node_address_name(child->address, name), how,
            node_place(entry->has_frame, entry->frame, entry->region, place));
}

/* What the end of a child means for the run. */
enum verdict { GOES_ON, HAS_LOST_ANOTHER, IS_OVER };

static enum verdict judge(const struct local_cluster *cluster, const struct child *child,
                          int *exit_status) {
    const bool is_host = child->address.role == NODE_HOST;
    if (WIFSIGNALED(child->result)) {
        report_loss(cluster, child);
        *exit_status = 3;
        return IS_OVER;
    }
    const int code = WEXITSTATUS(child->result);
    if (code == status_exit_code(STATUS_LOST)) {
        *exit_status = code;
        return HAS_LOST_ANOTHER;
    }
    if (is_host) {
        *exit_status = code;
        return IS_OVER;
    }
    if (code == 0)
        return GOES_ON;
    *exit_status = code;
    return HAS_LOST_ANOTHER; /* it told the host why, which will say so */
}

static int supervise(struct local_cluster *cluster) {
    int exit_status = 0, patience_ms = -1;
    const struct child *suspect = NULL;
    for (;;) {
        if (program_stop)
            return 128 + (int)program_stop;
        if (program_describe) {
            program_describe = 0;
            signal_all(cluster, SIGUSR1);
        }
        struct child *child = reap(cluster);
        if (child) {
            const enum verdict verdict = judge(cluster, child, &exit_status);
            if (verdict == IS_OVER)
                return exit_status;
            if (verdict == HAS_LOST_ANOTHER && patience_ms < 0) {
                patience_ms = CAUSE_PATIENCE_MS;
                suspect = child;
            }
            continue;
        }
        if (patience_ms >= 0 && (patience_ms -= POLL_MS) < 0) {
            report_loss(cluster, suspect); /* nobody came forward */
            return exit_status;
        }
        pause_ms(POLL_MS);
    }
}

/* Every node is a process with files; libzmq ends one that runs out of them: refuse beforehand. The
 * host has the most connections. */
static bool can_start(const struct render_options *options, struct status *status) {
    enum { FILES_PER_NODE = 3, FILES_BESIDES = 64 };
    const long nodes = (long)options->host.rendering_nodes + options->host.shading_nodes + 1;
    const long needed = FILES_PER_NODE * nodes + FILES_BESIDES;
    if (nodes + 1 > LOCAL_NODES_MAX)
        return status_fail(status, STATUS_INVALID,
                           "a cluster of %ld nodes is more than the %d processes one machine "
                           "should start: use --driver in-process, or start nodes on several "
                           "machines (sortlast-host)",
                           nodes + 1, LOCAL_NODES_MAX);
    if (program_files_max() >= needed)
        return true;
    return status_fail(status, STATUS_LIMIT,
                       "a cluster of %ld nodes needs %ld open files, the limit is %ld: raise it "
                       "(ulimit -n), or use "
                       "--driver in-process",
                       nodes + 1, needed, program_files_max());
}

int local_cluster_run(int argument_count, char **arguments, const struct render_options *options) {
    struct local_cluster cluster = {
        .options = options, .board_descriptor = -1, .pool_descriptor = -1};
    struct status status = {0};
    program_streams_ensure();
    program_signals_install();
    program_files_raise();
    int exit_status;
    if (can_start(options, &status) && start_all(&cluster, argument_count, arguments, &status)) {
        exit_status = supervise(&cluster);
    } else {
        exit_status = status_exit_code(status.code);
        fprintf(stderr, "sortlast: %s\n", status.message);
    }
    end_all(&cluster, exit_status == 0);
    remove_folder(cluster.folder);
    free(cluster.children);
    return exit_status;
}
