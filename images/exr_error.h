/* SPDX-License-Identifier: Apache-2.0 */
#ifndef IMAGES_EXR_ERROR_H
#define IMAGES_EXR_ERROR_H

#include "base/status.h"

#include <OpenEXR/openexr.h>

/* OpenEXRCore reports what went wrong through a callback on the thread where it happened, else it
 * prints. This keeps the first report of each thread until it is asked for. */
void exr_error_keep(exr_const_context_t context, exr_result_t code, const char *message);
void exr_error_forget(void);
/* The kept report, or the library's general sentence for the code. Valid until the next report of
 * the thread. */
const char *exr_error_text(exr_result_t code);

#endif
