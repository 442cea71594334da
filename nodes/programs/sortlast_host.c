/* SPDX-License-Identifier: Apache-2.0 */
#include "nodes/programs/host_run.h"

int main(int argc, char **argv) {
    struct render_options options;
    const int end = render_options_parse(argc, argv, true, &options);
    const int result = end ? end - 1 : host_run(&options);
    render_options_finish(&options);
    return result;
}
