/* SPDX-License-Identifier: Apache-2.0 */
#include "scenes/scene.h"

#include <stdlib.h>

void scene_frame_destroy(struct scene_frame *frame) {
    if (!frame)
        return;
    arena_finish(&frame->arena);
    free(frame);
}
