/* SPDX-License-Identifier: Apache-2.0 */
#include "nodes/programs/shader_command.h"

#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

/* Pixel memory as a map: instructions to the right, addresses downwards, a box for each variable
 * while it holds its bytes. */

enum { PLOT_WIDTH = 900, BYTE_HEIGHT = 5, LEFT = 60, TOP = 40, BOTTOM = 40 };

struct text {
    char *bytes;
    size_t length, capacity;
};

static void add(struct text *text, const char *format, ...) __attribute__((format(printf, 2, 3)));
static void add(struct text *text, const char *format, ...) {
    char piece[512];
    va_list arguments;
    va_start(arguments, format);
    const int length = vsnprintf(piece, sizeof piece, format, arguments);
    va_end(arguments);
    const size_t size = length < (int)sizeof piece ? (size_t)length : sizeof piece - 1;
    text->bytes = memory_grow(text->bytes, &text->capacity, text->length + size + 1, 1);
    memcpy(text->bytes + text->length, piece, size);
    text->length += size;
    text->bytes[text->length] = 0;
}

static double x_of(const struct shader_memory *m, int instruction) {
    return LEFT + (double)instruction * PLOT_WIDTH / (m->instructions + 1);
}

static void add_box(struct text *text, const struct shader_memory *m,
                    const struct shader_lifetime *life, int number) {
    static const char *const colours[] = {"#7fb3d5", "#f0b27a", "#82e0aa",
                                          "#d7bde2", "#f7dc6f", "#f1948a"};
    const double x = x_of(m, life->first), width = x_of(m, life->last + 1) - x;
    add(text,
        "<rect x=\"%.1f\" y=\"%d\" width=\"%.1f\" height=\"%d\" fill=\"%s\" stroke=\"#555\" "
        "stroke-width=\"0.3\"><title>%s line %d, %d bytes at %d</title></rect>\n",
        x, TOP + life->address * BYTE_HEIGHT, width, life->bytes * BYTE_HEIGHT, colours[number % 6],
        life->name[0] ? life->name : "temporary", life->line, life->bytes, life->address);
    if (life->name[0] && width > 6.0 * (double)strlen(life->name) && life->bytes >= 2)
        add(text, "<text x=\"%.1f\" y=\"%d\">%s</text>\n", x + 2,
            TOP + life->address * BYTE_HEIGHT + 9, life->name);
}

char *shader_report_svg(const struct shader_report *report) {
    const struct shader_memory *m = &report->program->memory;
    struct text text = {0};
    const int height = TOP + m->allocated * BYTE_HEIGHT + BOTTOM;
    add(&text,
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"%d\" height=\"%d\" "
        "font-family=\"sans-serif\" font-size=\"9\">\n",
        LEFT + PLOT_WIDTH + 20, height);
    add(&text, "<rect width=\"100%%\" height=\"100%%\" fill=\"white\"/>\n");
    add(&text,
        "<text x=\"%d\" y=\"16\" font-size=\"13\">%s: %d bytes of variables, %d varying, %d "
        "allocated</text>\n",
        LEFT, report->program->name, m->total, m->varying, m->allocated);
    if (m->illum_end >= m->illum_begin)
        add(&text,
            "<rect x=\"%.1f\" y=\"%d\" width=\"%.1f\" height=\"%d\" fill=\"#fef9e7\"/>\n<text "
            "x=\"%.1f\" y=\"%d\">illum</text>\n",
            x_of(m, m->illum_begin), TOP - 10, x_of(m, m->illum_end + 1) - x_of(m, m->illum_begin),
            m->allocated * BYTE_HEIGHT + 10, x_of(m, m->illum_begin) + 2, TOP - 2);
    for (int i = 0; i < m->lifetime_count; i++)
        if (m->lifetimes[i].address >= 0)
            add_box(&text, m, &m->lifetimes[i], i);
    for (int byte = 0; byte <= m->allocated; byte += 16)
        add(&text, "<text x=\"%d\" y=\"%d\" text-anchor=\"end\">%d</text>\n", LEFT - 4,
            TOP + byte * BYTE_HEIGHT + 4, byte);
    add(&text, "<text x=\"%d\" y=\"%d\">instructions, in the order of the array: %d</text>\n", LEFT,
        height - 12, m->instructions);
    add(&text, "</svg>\n");
    return text.bytes;
}
