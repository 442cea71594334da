/* SPDX-License-Identifier: Apache-2.0 */
#ifndef INSTANCE_MERGE_H
#define INSTANCE_MERGE_H

#include "nodes/shading_frame.h"

/* Instances of one shader function that differ in no uniform value have the same instruction
 * stream, and the array runs it once for all of them, each sample with the values loaded for its
 * shader ID: what PF section 7 names as an improvement not yet made. */

/* For each of `count` prepared instances the first that it runs with, itself when there is none
 * before it: leaders[i] <= i. */
void instance_merge(struct prepared_shader *const *instances, size_t count, uint32_t *leaders);

#endif
