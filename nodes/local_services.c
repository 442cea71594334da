/* SPDX-License-Identifier: Apache-2.0 */
#include "nodes/local_services.h"

#include "images/image.h"
#include "shaders/loader/shader_cache.h"

#include <pthread.h>
#include <stdlib.h>
#include <string.h>

enum { IMAGES_WAITING_MAX = 2 }; /* more would only hold memory */

struct image_job {
    struct image *image;
    char *path;
    enum image_compression compression;
    bool as_png_too;
};

struct local_services {
    struct node_services interface;
    struct trace *trace;
    struct shader_cache *cache; /* opened when first needed */
    const volatile sig_atomic_t *stop;
    const char *link;
    pthread_t writer;
    bool has_writer;
    pthread_mutex_t lock;
    pthread_cond_t changed;
    struct image_job waiting[IMAGES_WAITING_MAX];
    int waiting_count, writing_count;
    bool is_ending, has_failed;
    struct status failure; /* of the first picture that could not be written */
};

static bool open_cache(struct local_services *services, struct status *status) {
    if (services->cache)
        return true;
    if (!shader_cache_open(&services->cache, status))
        return false;
    shader_cache_set_stop(services->cache, services->stop);
    shader_cache_set_link(services->cache, services->link);
    trace_line(services->trace, "shaders run on vectors of %s",
               shader_cache_vectors(services->cache));
    return true;
}

static bool load_shader(void *context, const char *name, const char *c_source,
                        const struct shader_module **module, struct status *status) {
    struct local_services *services = context;
    if (!open_cache(services, status))
        return false;
    trace_line(services->trace, "loads shader %s", name);
    return shader_cache_load(services->cache, (struct shader_cache_source){name, c_source}, module,
                             status);
}

bool local_services_build_shaders(void *context, const char *const *names,
                                  const char *const *sources, size_t count, size_t *compiled,
                                  struct status *status) {
    struct local_services *services = context;
    struct shader_cache_source *list = memory_get(count, sizeof *list);
    for (size_t i = 0; i < count; i++)
        list[i] = (struct shader_cache_source){names[i], sources[i]};
    bool ok = open_cache(services, status) &&
              shader_cache_build(services->cache, list, count, compiled, status);
    free(list);
    return ok;
}

/* "picture.exr" -> "picture.png" */
static char *png_path(const char *path) {
    const char *slash = strrchr(path, '/'), *dot = strrchr(slash ? slash : path, '.');
    const size_t stem = dot ? (size_t)(dot - path) : strlen(path);
    char *png = memory_get(stem + 5, 1);
    memcpy(png, path, stem);
    memcpy(png + stem, ".png", 5);
    return png;
}

static bool write_job(const struct image_job *job, struct status *status) {
    if (!image_write_exr(job->image, job->path, job->compression, NULL, status))
        return false;
    bool ok = true;
    if (job->as_png_too) {
        char *png = png_path(job->path);
        ok = image_write_png(job->image, png, status);
        free(png);
    }
    return ok;
}

static void *write_images(void *context) {
    struct local_services *services = context;
    pthread_mutex_lock(&services->lock);
    for (;;) {
        while (!services->waiting_count && !services->is_ending)
            pthread_cond_wait(&services->changed, &services->lock);
        if (!services->waiting_count)
            break;
        const struct image_job job = services->waiting[0];
        memmove(services->waiting, services->waiting + 1,
                (size_t)--services->waiting_count * sizeof *services->waiting);
        services->writing_count++;
        pthread_cond_broadcast(&services->changed);
        pthread_mutex_unlock(&services->lock);
        struct status failure = {0};
        const bool ok = write_job(&job, &failure);
        image_destroy(job.image);
        free(job.path);
        pthread_mutex_lock(&services->lock);
        services->writing_count--;
        if (!ok && !services->has_failed) {
            services->has_failed = true;
            services->failure = failure;
        }
        pthread_cond_broadcast(&services->changed);
    }
    pthread_mutex_unlock(&services->lock);
    return NULL;
}

static bool write_image(void *context, struct image *image, const char *path, uint32_t compression,
                        bool as_png_too, struct status *status) {
    struct local_services *services = context;
    pthread_mutex_lock(&services->lock);
    if (!services->has_writer)
        services->has_writer = !pthread_create(&services->writer, NULL, write_images, services);
    while (services->has_writer && services->waiting_count == IMAGES_WAITING_MAX &&
           !services->has_failed)
        pthread_cond_wait(&services->changed, &services->lock);
    bool ok = services->has_writer && !services->has_failed;
    if (ok) {
        services->waiting[services->waiting_count++] = (struct image_job){
            image, memory_copy_string(path), (enum image_compression)compression, as_png_too};
        pthread_cond_broadcast(&services->changed);
    } else {
        image_destroy(image);
        if (services->has_failed)
            *status = services->failure;
        else
            status_fail(status, STATUS_LIMIT, "cannot start a thread to write pictures");
    }
    pthread_mutex_unlock(&services->lock);
    return ok;
}

static bool finish_images(void *context, struct status *status) {
    struct local_services *services = context;
    pthread_mutex_lock(&services->lock);
    while (services->waiting_count || services->writing_count)
        pthread_cond_wait(&services->changed, &services->lock);
    const bool ok = !services->has_failed;
    if (!ok)
        *status = services->failure;
    pthread_mutex_unlock(&services->lock);
    return ok;
}

struct local_services *local_services_create(struct trace *trace,
                                             const volatile sig_atomic_t *stop) {
    struct local_services *services = memory_get(1, sizeof *services);
    services->trace = trace;
    services->stop = stop;
    services->interface = (struct node_services){services, load_shader, write_image, finish_images};
    pthread_mutex_init(&services->lock, NULL);
    pthread_cond_init(&services->changed, NULL);
    return services;
}

void local_services_set_link(struct local_services *services, const char *object) {
    services->link = object;
}

void local_services_destroy(struct local_services *services) {
    if (!services)
        return;
    pthread_mutex_lock(&services->lock);
    services->is_ending = true;
    pthread_cond_broadcast(&services->changed);
    pthread_mutex_unlock(&services->lock);
    if (services->has_writer)
        pthread_join(services->writer, NULL);
    pthread_mutex_destroy(&services->lock);
    pthread_cond_destroy(&services->changed);
    shader_cache_close(services->cache);
    free(services);
}

const struct node_services *local_services_interface(struct local_services *services) {
    return &services->interface;
}
