/* SPDX-License-Identifier: Apache-2.0 */
/* One source for sortlast-rendering-node, sortlast-shading-node and sortlast-framebuffer-node:
 * NODE_PROGRAM_ROLE says which. */
#include "nodes/driver_sockets.h"
#include "nodes/framebuffer_node.h"
#include "nodes/local_services.h"
#include "nodes/programs/program_process.h"
#include "nodes/rendering_node.h"
#include "nodes/shading_node.h"
#include "nodes/visibility.h"

#include <getopt.h>
#include <stdio.h>
#include <stdlib.h>

struct node_program_options {
    struct socket_options sockets;
    uint32_t index;
    int board, pool;
    unsigned board_entry, pool_ring;
    const char *link; /* object with extern "C" functions of shaders, NULL: none */
    bool is_verbose;
    pid_t supervisor; /* 0: none */
};

static void print_help(void) {
    printf("usage: %s --host ENDPOINT [--index N] [options]\n"
           "\n"
           "One %s of a cluster. It calls the host, joins the cluster and leaves when the host is "
           "done.\n"
           "\n"
           "      --host ENDPOINT    where the host listens: ipc://PATH or tcp://ADDRESS:PORT\n"
           "      --index N          which of the nodes of its kind it is, from 0 (default 0)\n"
           "      --listen ENDPOINT  where it takes regions (default: beside the host's ipc "
           "socket; for tcp a\n"
           "                         free port of the loopback interface, tcp://127.0.0.1:*; "
           "across machines\n"
           "                         give an address the others can reach, tcp://10.0.0.7:*)\n"
           "      --deadline S       how long to wait for the host to begin (default 60)\n"
           "      --link FILE.so     let shaders call the extern \"C\" functions of this object (a "
           "shading node)\n"
           "      --status-board FD:ENTRY  inherited descriptor of a supervisor's status board\n"
           "      --shared-pool FD:RING  inherited descriptor of memory shared by the nodes of a "
           "local cluster\n"
           "      --supervisor PID   the process that started this one and reports lost nodes\n"
           "  -v, --verbose          say what it does\n"
           "  -h, --help             this text\n"
           "\n"
           "SIGUSR1 makes it say what it waits for. Exit status: 0 done; 1 bad input; 2 something "
           "around it\n"
           "failed; 3 the host or another node was lost.\n",
           node_role_program(NODE_PROGRAM_ROLE), node_role_name(NODE_PROGRAM_ROLE));
}

/* 0 to go on, else exit status plus 1. */
static int parse(int argc, char **argv, struct node_program_options *options) {
    static const struct option long_options[] = {
        {"host", required_argument, NULL, 'H'},
        {"index", required_argument, NULL, 'i'},
        {"listen", required_argument, NULL, 'l'},
        {"deadline", required_argument, NULL, 'd'},
        {"link", required_argument, NULL, 'L'},
        {"status-board", required_argument, NULL, 'b'},
        {"supervisor", required_argument, NULL, 'S'},
        {"shared-pool", required_argument, NULL, 'p'},
        {"verbose", no_argument, NULL, 'v'},
        {"help", no_argument, NULL, 'h'},
        {0},
    };
    int option;
    bool ok = true;
    char *end;
    options->board = options->pool = -1;
    options->sockets.deadline_s = 60;
    while ((option = getopt_long(argc, argv, "vh", long_options, NULL)) != -1)
        switch (option) {
        case 'H':
            options->sockets.host = optarg;
            break;
        case 'i':
            options->index = (uint32_t)strtoul(optarg, &end, 10);
            ok = ok && !*end && options->index < 65536;
            break;
        case 'l':
            options->sockets.listen = optarg;
            break;
        case 'd':
            options->sockets.deadline_s = atoi(optarg);
            ok = ok && options->sockets.deadline_s > 0;
            break;
        case 'L':
            options->link = optarg;
            break;
        case 'b':
            ok = ok && sscanf(optarg, "%d:%u", &options->board, &options->board_entry) == 2;
            break;
        case 'p':
            ok = ok && sscanf(optarg, "%d:%u", &options->pool, &options->pool_ring) == 2;
            break;
        case 'S':
            options->supervisor = atoi(optarg);
            ok = ok && options->supervisor > 0;
            break;
        case 'v':
            options->is_verbose = true;
            break;
        case 'h':
            print_help();
            return 1;
        default:
            ok = false;
        }
    if (ok && options->sockets.host && optind == argc)
        return 0;
    fprintf(stderr, "%s: %s (see --help)\n", node_role_program(NODE_PROGRAM_ROLE),
            !options->sockets.host ? "--host is missing: where does the host listen?"
                                   : "an option is unknown or has a value that cannot be");
    return 2;
}

static bool create(const struct node_program_options *options, struct local_services *services,
                   struct visibility_device **device, struct trace *trace, struct node **node,
                   struct status *status) {
    switch (NODE_PROGRAM_ROLE) {
    case NODE_RENDERING:
        return visibility_device_create(device, status) &&
               rendering_node_create(options->index, *device, trace, node, status);
    case NODE_SHADING:
        return shading_node_create(options->index, local_services_interface(services), trace, node,
                                   status);
    default:
        return framebuffer_node_create(local_services_interface(services), trace, node, status);
    }
}

int main(int argc, char **argv) {
    struct node_program_options options = {0};
    struct status status = {0};
    struct trace trace;
    struct node *node = NULL;
    char name[NODE_NAME_BYTES];
    const int end = parse(argc, argv, &options);
    if (end)
        return end - 1;
    program_streams_ensure();
    program_signals_install();
    program_files_raise();
    program_memory_keep();
    trace_init(&trace,
               node_address_name((struct node_address){NODE_PROGRAM_ROLE, options.index}, name),
               options.is_verbose ? stderr : NULL);
    options.sockets.stop = &program_stop;
    options.sockets.describe = &program_describe;
    if (options.board >= 0)
        options.sockets.board = status_board_open(options.board, options.board_entry);
    if (options.pool >= 0)
        options.sockets.pool = shared_pool_open(options.pool, options.pool_ring);
    struct local_services *services = local_services_create(&trace, &program_stop);
    local_services_set_link(services, options.link);
    struct visibility_device *device = NULL;
    bool ok = create(&options, services, &device, &trace, &node, &status) &&
              driver_sockets_run(node, &options.sockets, &status);
    /* under a supervisor the host, once it can be told, or the supervisor itself reports */
    const bool is_told =
        options.supervisor && options.sockets.board && options.sockets.board->is_started;
    if (!ok && status.code != STATUS_OK && !is_told)
        fprintf(stderr, "sortlast: %s: %s\n", name, status.message);
    node_destroy(node);
    visibility_device_destroy(device);
    shared_pool_close(options.sockets.pool);
    local_services_destroy(services);
    return ok                         ? 0
           : status.code == STATUS_OK ? 128 + (int)program_stop
                                      : status_exit_code(status.code);
}
