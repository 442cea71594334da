/* SPDX-License-Identifier: Apache-2.0 */
#include "accuracy.h"

#include <pthread.h>

void run_on_threads(int threads, void *(*work)(void *), void *argument) {
    pthread_t others[63];
    int started = 0;
    while (started < threads - 1 && started < 63 &&
           pthread_create(&others[started], NULL, work, argument) == 0)
        started++;
    work(argument);
    for (int i = 0; i < started; i++)
        pthread_join(others[i], NULL);
}
