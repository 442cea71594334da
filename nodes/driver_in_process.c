/* SPDX-License-Identifier: Apache-2.0 */
#include "nodes/driver_in_process.h"

#include "base/rng.h"

#include <stdlib.h>
#include <string.h>

/* Messages from one node to another, in order. */
struct link {
    size_t from, to;
    struct message **messages;
    size_t first, count, capacity;
};

struct in_process {
    struct node **nodes;
    size_t node_count;
    const struct driver_options *options;
    struct rng rng;
    struct link *links;
    size_t link_count, link_capacity;
};

static size_t node_index(const struct in_process *run, struct node_address address) {
    for (size_t i = 0; i < run->node_count; i++)
        if (run->nodes[i]->address.role == address.role &&
            run->nodes[i]->address.index == address.index)
            return i;
    return run->node_count;
}

static struct link *link_between(struct in_process *run, size_t from, size_t to) {
    for (size_t i = 0; i < run->link_count; i++)
        if (run->links[i].from == from && run->links[i].to == to)
            return &run->links[i];
    run->links =
        memory_grow(run->links, &run->link_capacity, run->link_count + 1, sizeof *run->links);
    run->links[run->link_count] = (struct link){.from = from, .to = to};
    return &run->links[run->link_count++];
}

static void link_push(struct link *link, struct message *message) {
    if (link->first && link->first + link->count == link->capacity) {
        memmove(link->messages, link->messages + link->first, link->count * sizeof *link->messages);
        link->first = 0;
    }
    link->messages = memory_grow(link->messages, &link->capacity, link->first + link->count + 1,
                                 sizeof *link->messages);
    link->messages[link->first + link->count++] = message;
}

static bool step_node(struct in_process *run, size_t index, const struct node_event *event,
                      struct status *status) {
    struct node_outputs outputs = {0};
    struct node *node = run->nodes[index];
    bool ok = node_step(node, event, &outputs, status);
    if (!ok && node->address.role != NODE_HOST) { /* the host's errors name a place in the scene */
        char name[NODE_NAME_BYTES];
        status_prefix(status, "%s", node_address_name(node->address, name));
    }
    for (size_t i = 0; i < outputs.count; i++) {
        const size_t to = node_index(run, outputs.items[i].to);
        if (run->options->tap)
            run->options->tap(run->options->tap_context, node->address, &outputs.items[i]);
        if (to < run->node_count)
            link_push(link_between(run, index, to), outputs.items[i].message);
        else
            message_release(outputs.items[i].message);
    }
    free(outputs.items);
    return ok;
}

static bool deliver(struct in_process *run, struct link *link, struct status *status) {
    struct node_event event = {.kind = NODE_MESSAGE, .message = link->messages[link->first]};
    const size_t to = link->to;
    link->first = --link->count ? link->first + 1 : 0;
    bool ok = wire_open(event.message->bytes, event.message->length, &event.header, status) &&
              step_node(run, to, &event, status);
    message_release(event.message);
    return ok;
}

static unsigned downstream_rank(struct node_address address) {
    static const unsigned rank[NODE_ROLE_COUNT] = {
        [NODE_HOST] = 0, [NODE_RENDERING] = 1, [NODE_SHADING] = 2, [NODE_FRAMEBUFFER] = 3};
    return rank[address.role] << 24 | address.index;
}

/* What may happen next: deliver the head of a link, or let a node work. */
struct choice {
    struct link *link; /* NULL: node works */
    size_t node;
};

static bool choose(struct in_process *run, struct choice *choice) {
    unsigned best = 0;
    uint64_t options = 0;
    for (size_t i = 0; i < run->link_count + run->node_count; i++) {
        struct link *link = i < run->link_count ? &run->links[i] : NULL;
        const size_t node = link ? link->to : i - run->link_count;
        if (link ? link->count == 0 : !run->nodes[node]->has_work)
            continue;
        options++;
        const unsigned rank = downstream_rank(run->nodes[node]->address) + 1;
        const bool take = run->options->seed ? rng_below(&run->rng, options) == 0 : rank > best;
        if (take) {
            *choice = (struct choice){link, node};
            best = rank;
        }
    }
    return options > 0;
}

static struct node *host_of(const struct in_process *run) {
    for (size_t i = 0; i < run->node_count; i++)
        if (run->nodes[i]->address.role == NODE_HOST)
            return run->nodes[i];
    return NULL;
}

static bool describe_standstill(const struct in_process *run, struct status *status) {
    char text[1024] = "";
    for (size_t i = 0; i < run->node_count && strlen(text) < sizeof text - 256; i++) {
        char name[NODE_NAME_BYTES], what[160];
        run->nodes[i]->type->describe(run->nodes[i], what, sizeof what);
        const size_t used = strlen(text);
        snprintf(text + used, sizeof text - used, "\n  %s %s",
                 node_address_name(run->nodes[i]->address, name), what);
    }
    return status_fail(status, STATUS_INTERNAL, "the cluster stands still:%s", text);
}

bool driver_in_process_run(struct node **nodes, size_t count, const struct driver_options *options,
                           struct status *status) {
    struct in_process run = {
        .nodes = nodes, .node_count = count, .options = options, .rng = {options->seed}};
    struct node *host = host_of(&run);
    bool ok = host != NULL;
    for (size_t i = 0; ok && i < count; i++)
        ok = step_node(&run, i, &(struct node_event){.kind = NODE_START}, status);
    while (ok && !host->is_finished) {
        struct choice choice = {0};
        if (options->stop && *options->stop) {
            ok = false;
            break;
        }
        if (!choose(&run, &choice))
            ok = describe_standstill(&run, status);
        else if (choice.link)
            ok = deliver(&run, choice.link, status);
        else
            ok = step_node(&run, choice.node, &(struct node_event){.kind = NODE_WORK}, status);
    }
    for (size_t i = 0; i < run.link_count; i++) {
        for (size_t m = 0; m < run.links[i].count; m++)
            message_release(run.links[i].messages[run.links[i].first + m]);
        free(run.links[i].messages);
    }
    free(run.links);
    return ok;
}
