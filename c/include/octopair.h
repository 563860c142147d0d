/* octopair for C and for every language that calls C: finds every pair of overlapping boxes among millions.
 *
 * Errors      Each function that can fail returns an octopair_status. After a failure octopair_error_message() has the text, for the same
 *             thread. No exception leaves a function. Outputs are set only on success, unless their function says otherwise.
 * Handles     Types without a definition here. A function that ends in _create or _submit makes one; the function of the same name that
 *             ends in _destroy releases it and accepts NULL.
 * Structs     Each begins with its size in bytes, which tells the library the version of the header that the program was compiled with.
 *             The macros OCTOPAIR_..._INIT set the size and the defaults.
 * Ownership   Arrays are borrowed for the call, or until a job has ended. The library keeps none of them.
 * Threads     Any thread may use an engine, a job or a stop; the calls of an engine run one after another. Other handles are used by one
 *             thread at a time. Different handles are independent. No thread may use a handle while or after it is destroyed.
 * Units       Those of the caller. A box is six numbers: min x, y, z, max x, y, z. Boxes are closed: boxes that touch are a pair.
 * Result      Exact and complete, and the same bytes for every engine and any number of threads.
 * Link        liboctopair_c (pkg-config octopair-c, CMake octopair::c). C99 or later, or C++.
 */
#ifndef OCTOPAIR_H
#define OCTOPAIR_H

#include <stddef.h>
#include <stdint.h>

#if defined(__GNUC__)
#define OCTOPAIR_API __attribute__((visibility("default")))
#else
#define OCTOPAIR_API
#endif

#ifdef __cplusplus
extern "C" {
#endif

/* Outcome of a call. */
typedef enum octopair_status {
    OCTOPAIR_OK = 0,
    OCTOPAIR_USAGE = 1,          /* options contradict each other, or the call is not supported here */
    OCTOPAIR_BAD_INPUT = 2,      /* a box, a number or a pointer is invalid */
    OCTOPAIR_IO_FAILED = 3,      /* the operating system failed to read or write */
    OCTOPAIR_RESOURCE_LIMIT = 4, /* memory or another bounded resource ran out */
    OCTOPAIR_ENGINE_FAILED = 5,  /* an engine or a server failed, or its result is wrong */
    OCTOPAIR_CANCELLED = 6       /* a stop was requested, or a callback returned a number other than 0 */
} octopair_status;

/* Returns the message of the last failed call of this thread; "" if there was none. Valid until the thread's next call. */
OCTOPAIR_API const char *octopair_error_message(void);
/* Returns 1 if that failure is about one object, query or id, and stores its index and its set: 1 for the second set of a join, otherwise
 * 0. Returns 0 otherwise. Either pointer may be null. */
OCTOPAIR_API int octopair_error_place(uint64_t *index, uint32_t *set);
/* Returns the version of the library, for example "0.2.0". Static text. */
OCTOPAIR_API const char *octopair_version(void);

/* Indices of two objects; a < b, or a in the first set and b in the second. */
typedef struct octopair_pair {
    uint32_t a, b;
} octopair_pair;

typedef enum octopair_precision { OCTOPAIR_FLOAT32 = 0, OCTOPAIR_FLOAT64 = 1 } octopair_precision;
typedef enum octopair_order { OCTOPAIR_ASCENDING = 0, OCTOPAIR_OCTAL = 1 } octopair_order;

/* A set of objects, borrowed. */
typedef struct octopair_objects {
    size_t size;
    int32_t precision;     /* an octopair_precision: that of the boxes */
    int32_t reserved;      /* 0 */
    const void *boxes;     /* 6 * count numbers, float or double */
    uint64_t count;        /* at most 2^32 - 1 */
    const double *padding; /* clearance of each object: count numbers, or NULL */
} octopair_objects;
#define OCTOPAIR_OBJECTS_INIT {sizeof(octopair_objects), OCTOPAIR_FLOAT32, 0, NULL, 0, NULL}

/* Receives pairs in batches, in order, on the thread of the call. The array is valid during the call. Returns 0 to go on; another number
 * ends the search with OCTOPAIR_CANCELLED. Must not call the engine or the scene that calls it, which would wait for ever. */
typedef int (*octopair_sink)(void *data, const octopair_pair *pairs, size_t count);
/* Receives the fraction that is done, 0 to 1, one thread at a time, not always that of the call; for jobs, a thread of the engine. Returns
 * 0 to go on, like octopair_sink. Must not search with the engine that calls it, nor wait for its jobs; it may submit and cancel jobs. */
typedef int (*octopair_progress)(void *data, double fraction);

/* Cancels calls from another thread: each call that has this stop ends within 200 ms. */
typedef struct octopair_stop octopair_stop;
OCTOPAIR_API octopair_status octopair_stop_create(octopair_stop **stop);
OCTOPAIR_API void octopair_stop_request(octopair_stop *stop);
OCTOPAIR_API void octopair_stop_destroy(octopair_stop *stop);

typedef struct octopair_options {
    size_t size;
    int32_t order;             /* an octopair_order */
    int32_t verify;            /* 1: a second algorithm checks the result */
    double margin;             /* largest gap, per axis, at which a pair counts */
    uint64_t limit;            /* maximum number of pairs; UINT64_MAX: no limit; 0: no pairs */
    uint64_t buffer_bytes;     /* maximum memory for pairs while streaming */
    octopair_progress progress; /* or NULL */
    void *progress_data;
    octopair_stop *stop; /* or NULL; must outlive the call. Jobs ignore it: see octopair_job_cancel */
} octopair_options;
#define OCTOPAIR_OPTIONS_INIT \
    {sizeof(octopair_options), OCTOPAIR_ASCENDING, 0, 0.0, UINT64_MAX, UINT64_C(1) << 30, NULL, NULL, NULL}

/* Counts and times of a call. Set its size before; OCTOPAIR_SUMMARY_INIT does. */
typedef struct octopair_summary {
    size_t size;
    uint64_t pairs;    /* number of pairs */
    uint64_t entries;  /* number of entries in the octree */
    double seconds;    /* wall-clock time */
    int32_t truncated; /* 1: the limit was reached, and more pairs exist */
    int32_t verified;  /* 1: the result was checked, and no difference was found */
} octopair_summary;
#define OCTOPAIR_SUMMARY_INIT {sizeof(octopair_summary), 0, 0, 0.0, 0, 0}

/* Engines */

typedef struct octopair_engine octopair_engine;

typedef struct octopair_engine_options {
    size_t size;
    uint32_t threads;           /* of a local engine; 0: one per core */
    uint32_t workers;           /* of worker processes; 0: one per core */
    const char *worker_program; /* path of octopair-worker, or NULL: found as octopair/processes.hpp says */
    const char *token;          /* of a server, or NULL */
    const char *authority;      /* PEM file of a certificate authority, or NULL: no encryption, unless `tls` is 1 */
    const char *certificate;    /* PEM files of this client, or NULL */
    const char *key;
    int32_t tls;
    int32_t token_in_clear;  /* 1: the token is also sent to loopback addresses without encryption */
    double connect_timeout;  /* longest wait for the first connection, in seconds */
    double patience;         /* longest later outage of the server, in seconds */
} octopair_engine_options;
#define OCTOPAIR_ENGINE_OPTIONS_INIT \
    {sizeof(octopair_engine_options), 0, 0, NULL, NULL, NULL, NULL, NULL, 0, 0, 5.0, 30.0}

/* Makes an engine. `kind` is "local", "processes", or the address of a server, "unix:PATH" or "HOST:PORT". `options` may be NULL. */
OCTOPAIR_API octopair_status octopair_engine_create(const char *kind, const octopair_engine_options *options,
                                                    octopair_engine **engine);
/* Cancels the jobs of the engine, which remain valid. */
OCTOPAIR_API void octopair_engine_destroy(octopair_engine *engine);

/* A list of pairs. Reuse it: it keeps its memory. */
typedef struct octopair_pairs octopair_pairs;
OCTOPAIR_API octopair_status octopair_pairs_create(octopair_pairs **pairs);
OCTOPAIR_API void octopair_pairs_destroy(octopair_pairs *pairs);
OCTOPAIR_API uint64_t octopair_pairs_count(const octopair_pairs *pairs);
/* Copies pairs from position `first` on to `buffer`, at most `capacity`. Returns how many were copied. */
OCTOPAIR_API uint64_t octopair_pairs_copy(const octopair_pairs *pairs, uint64_t first, octopair_pair *buffer,
                                          uint64_t capacity);

/* In the calls below `second` is the second set of a join, or NULL; `options` and `summary` may be NULL. */

/* Finds the pairs and stores them in `pairs`, which is empty after a failure. */
OCTOPAIR_API octopair_status octopair_find_pairs(octopair_engine *engine, const octopair_objects *first,
                                                 const octopair_objects *second, const octopair_options *options,
                                                 octopair_pairs *pairs, octopair_summary *summary);
/* Counts the pairs and stores none of them. With a limit, the count is at most the limit. */
OCTOPAIR_API octopair_status octopair_count_pairs(octopair_engine *engine, const octopair_objects *first,
                                                  const octopair_objects *second, const octopair_options *options,
                                                  uint64_t *count);
/* Passes the pairs to `sink`, in order, in bounded memory. */
OCTOPAIR_API octopair_status octopair_stream_pairs(octopair_engine *engine, const octopair_objects *first,
                                                   const octopair_objects *second, const octopair_options *options,
                                                   octopair_sink sink, void *data, octopair_summary *summary);

/* Jobs run on a thread of the engine, one after another. */

typedef struct octopair_job octopair_job;
typedef enum octopair_job_state {
    OCTOPAIR_JOB_QUEUED = 0,
    OCTOPAIR_JOB_RUNNING = 1,
    OCTOPAIR_JOB_DONE = 2,
    OCTOPAIR_JOB_FAILED = 3,
    OCTOPAIR_JOB_ENDED_BY_CANCEL = 4
} octopair_job_state;

/* Starts a search and returns at once. Arrays must stay alive and unchanged until the job has ended. */
OCTOPAIR_API octopair_status octopair_job_submit(octopair_engine *engine, const octopair_objects *first,
                                                 const octopair_objects *second, const octopair_options *options,
                                                 octopair_job **job);
OCTOPAIR_API octopair_job_state octopair_job_get_state(const octopair_job *job);
/* Returns the fraction of the work that is done, 0 to 1; never decreases. */
OCTOPAIR_API double octopair_job_get_progress(const octopair_job *job);
/* Waits until the job has ended, at most `seconds`; a negative number: no limit. Sets `ended` to 1 or 0. */
OCTOPAIR_API octopair_status octopair_job_wait(octopair_job *job, double seconds, int *ended);
/* Requests that the job ends, and returns at once. A running job ends within 200 ms. */
OCTOPAIR_API void octopair_job_cancel(octopair_job *job);
/* Waits until the job has ended, and moves its pairs to `pairs`, once. Fails as the job did. */
OCTOPAIR_API octopair_status octopair_job_take_pairs(octopair_job *job, octopair_pairs *pairs, octopair_summary *summary);
/* Cancels the job and waits until the engine has released its arrays. */
OCTOPAIR_API void octopair_job_destroy(octopair_job *job);

/* Scenes: objects that persist and move. */

typedef struct octopair_scene octopair_scene;

/* Identifies an object of a scene. Pairs and queries use the index. */
typedef struct octopair_id {
    uint32_t index, generation;
} octopair_id;

/* Two objects can form a pair if each one's mask has a bit of the other's groups, and not both are fixed. */
typedef struct octopair_traits {
    uint32_t groups, mask;
    uint32_t fixed; /* 0 or 1 */
} octopair_traits;
#define OCTOPAIR_TRAITS_INIT {1, UINT32_MAX, 0}

typedef struct octopair_scene_options {
    size_t size;
    int32_t precision;     /* an octopair_precision: that of all boxes */
    uint32_t threads;      /* 0: one per core */
    double margin;         /* largest gap, per axis, at which a pair counts */
    double slack;          /* enlarges searched boxes: see octopair/scene.hpp; 0: none */
    const char *recording; /* path of a file that records all calls, or NULL */
} octopair_scene_options;
#define OCTOPAIR_SCENE_OPTIONS_INIT {sizeof(octopair_scene_options), OCTOPAIR_FLOAT32, 0, 0.0, 0.0, NULL}

/* `options` may be NULL. */
OCTOPAIR_API octopair_status octopair_scene_create(const octopair_scene_options *options, octopair_scene **scene);
OCTOPAIR_API void octopair_scene_destroy(octopair_scene *scene);
/* Adds objects and writes their ids. `traits` has one element per object, or is NULL. A call that fails changes nothing. */
OCTOPAIR_API octopair_status octopair_scene_add(octopair_scene *scene, const octopair_objects *objects,
                                                const octopair_traits *traits, octopair_id *ids);
/* Gives objects new boxes: 6 * count numbers of the scene's precision. If an id occurs twice, the last box counts. */
OCTOPAIR_API octopair_status octopair_scene_move(octopair_scene *scene, const octopair_id *ids, const void *boxes,
                                                 uint64_t count);
/* Like octopair_scene_move, but in the next step the box of an object is the union of its old and its new box. */
OCTOPAIR_API octopair_status octopair_scene_sweep(octopair_scene *scene, const octopair_id *ids, const void *boxes,
                                                  uint64_t count);
/* Removes objects. An id that occurs twice is an error. */
OCTOPAIR_API octopair_status octopair_scene_remove(octopair_scene *scene, const octopair_id *ids, uint64_t count);
OCTOPAIR_API octopair_status octopair_scene_set_traits(octopair_scene *scene, const octopair_id *ids,
                                                       const octopair_traits *traits, uint64_t count);
OCTOPAIR_API uint64_t octopair_scene_count(const octopair_scene *scene);

/* Result of a step. Arrays are valid until the scene's next call. */
typedef struct octopair_step {
    size_t size;
    const octopair_pair *began, *ended; /* pairs that began and ended, ascending */
    uint64_t began_count, ended_count;
    uint64_t persisting; /* number of pairs that existed before and still exist */
    double seconds;
    int32_t full; /* 1: all objects were searched, not only the changed ones */
    int32_t reserved;
} octopair_step;
#define OCTOPAIR_STEP_INIT {sizeof(octopair_step), NULL, NULL, 0, 0, 0, 0.0, 0, 0}

/* Finds the pairs that began and ended since the last step. `stop` may be NULL. */
OCTOPAIR_API octopair_status octopair_scene_step(octopair_scene *scene, octopair_stop *stop, octopair_step *step);
/* Passes all pairs of the last step to `sink`, ascending. */
OCTOPAIR_API octopair_status octopair_scene_pairs(octopair_scene *scene, octopair_sink sink, void *data);

/* Answers to queries, flat: those to query q are at offsets[q] to offsets[q + 1]. Reuse it: it keeps its memory. */
typedef struct octopair_answers octopair_answers;
OCTOPAIR_API octopair_status octopair_answers_create(octopair_answers **answers);
OCTOPAIR_API void octopair_answers_destroy(octopair_answers *answers);
OCTOPAIR_API uint64_t octopair_answers_queries(const octopair_answers *answers);
/* Arrays are valid until the answers are next written. `values`: positions along rays, or distances; NULL after overlaps. */
OCTOPAIR_API const uint64_t *octopair_answers_offsets(const octopair_answers *answers);
OCTOPAIR_API const uint32_t *octopair_answers_indices(const octopair_answers *answers);
OCTOPAIR_API const double *octopair_answers_values(const octopair_answers *answers);

/* Queries use the current boxes, without margin and padding, and consider only objects that have a bit of `groups`. */
#define OCTOPAIR_ALL_GROUPS UINT32_MAX
/* Objects that overlap boxes: 6 * count numbers. Ascending by index. */
OCTOPAIR_API octopair_status octopair_scene_overlap_boxes(octopair_scene *scene, const double *boxes, uint64_t count,
                                                          uint32_t groups, octopair_answers *answers);
/* Objects that overlap balls: 4 * count numbers, centre and radius. */
OCTOPAIR_API octopair_status octopair_scene_overlap_balls(octopair_scene *scene, const double *balls, uint64_t count,
                                                          uint32_t groups, octopair_answers *answers);
/* Objects that rays hit: 7 * count numbers, origin, direction and the largest position along the ray (may be infinite). `all` is 0 for the
 * first hit of each ray, 1 for all. */
OCTOPAIR_API octopair_status octopair_scene_hits(octopair_scene *scene, const double *rays, uint64_t count, int all,
                                                 uint32_t groups, octopair_answers *answers);
/* The `k` objects nearest to places: boxes, 6 * count numbers; a point is a box without extent. Objects farther away than `within` are
 * left out, which saves time; INFINITY: none. */
OCTOPAIR_API octopair_status octopair_scene_nearest(octopair_scene *scene, const double *places, uint64_t count, uint64_t k,
                                                    double within, uint32_t groups, octopair_answers *answers);

#ifdef __cplusplus
}
#endif
#endif
