/* SPDX-License-Identifier: Apache-2.0 */
#ifndef MACHINE_COMMAND_H
#define MACHINE_COMMAND_H

/* The verb `sortlast machine`: shows a machine description with the source of every number, lists
 * the ones that come with the program, checks a file. Returns the exit status. */
int machine_main(int argc, char **argv);

#endif
