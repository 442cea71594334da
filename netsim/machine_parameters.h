/* SPDX-License-Identifier: Apache-2.0 */
#ifndef MACHINE_PARAMETERS_H
#define MACHINE_PARAMETERS_H

/* Every number of a machine description, once: the structure, the JSON schema, the wire form, the
 * checks and `sortlast machine` derive from this list. All are whole numbers.
 *
 * X(name, unit, minimum, maximum, what it is) */
#define MACHINE_PARAMETERS(X)                                                                      \
    X(region_width, "samples", 8, 512, "width of a region, one pixel processor per sample")        \
    X(region_height, "samples", 8, 512, "height of a region")                                      \
    X(pixel_memory_bytes, "bytes", 16, 65536, "memory of one pixel processor")                     \
    X(texture_memory_bytes, "bytes", 0, 1000000000000000, "texture memory of a node")              \
    X(processor_memory_bytes, "bytes", 0, 1000000000000000, "memory of a node's processors")       \
    X(composition_bytes_per_s, "bytes/s", 1, 1000000000000000,                                     \
      "rate of a composition link, each way")                                                      \
    X(composition_word_bytes, "bytes", 8, 4096, "width of a composition transfer, depth included") \
    X(composition_depth_bytes, "bytes", 4, 4, "depth in each composition word")                    \
    X(composition_shader_id_bytes, "bytes", 2, 2, "shader ID at the head of every transfer map")   \
    X(composition_hop_latency_ps, "ps", 0, 1000000000000,                                          \
      "delay of one hop of the composition network")                                               \
    X(composition_region_buffers, "regions", 1, 1024, "region buffers of a node")                  \
    X(colour_words, "words", 1, 64, "composition words a sample of shaded colour takes")           \
    X(geometry_bytes_per_s, "bytes/s", 1, 1000000000000000, "rate of the geometry network")        \
    X(geometry_word_bytes, "bytes", 1, 4096, "width of the geometry network")                      \
    X(geometry_frame_buffers, "frames", 1, 64, "frames a node holds while another is composed")    \
    X(raster_triangle_ps, "ps", 0, 1000000000000, "a triangle in a region, on a rendering node")   \
    X(raster_region_ps, "ps", 0, 1000000000000, "begin of a region that holds any triangle")       \
    X(shading_region_ps, "ps", 0, 1000000000000,                                                   \
      "begin of a region on a shading node, whatever its shaders")                                 \
    X(target_frames_per_s, "frames/s", 1, 100000, "rate that budgets aim at")

#endif
