/* SPDX-License-Identifier: Apache-2.0 */
#ifndef TEST_HARNESS_H
#define TEST_HARNESS_H

/* cmocka wants these before itself, in this order. */
/* clang-format off */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>
/* clang-format on */

#endif
