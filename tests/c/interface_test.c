/* Tests every function of octopair.h. The same file is compiled as C99 and as C++.
 *
 *     interface_test [ADDRESS]     ADDRESS: a server, tested like the other engines
 */
#include <math.h>
#include <octopair.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static int failures = 0;

#define CHECK(condition)                                                                              \
    do {                                                                                              \
        if (!(condition)) {                                                                           \
            fprintf(stderr, "%s:%d: not true: %s (last error: %s)\n", __FILE__, __LINE__, #condition, \
                    octopair_error_message());                                                        \
            ++failures;                                                                               \
        }                                                                                             \
    } while (0)
#define CHECK_OK(call) CHECK((call) == OCTOPAIR_OK)

enum { COUNT = 400 };

typedef struct pair_array {
    octopair_pair* pairs;
    size_t count, room;
} pair_array;

static int collect(void* data, const octopair_pair* pairs, size_t count) {
    pair_array* all = (pair_array*)data;
    if (all->count + count > all->room) {
        all->room = 2 * (all->count + count);
        all->pairs = (octopair_pair*)realloc(all->pairs, all->room * sizeof *pairs);
    }
    memcpy(all->pairs + all->count, pairs, count * sizeof *pairs);
    all->count += count;
    return 0;
}

static int refuse(void* data, const octopair_pair* pairs, size_t count) {
    (void)data, (void)pairs, (void)count;
    return 1;
}

static int note_progress(void* data, double fraction) {
    *(double*)data = fraction;
    return 0;
}

static int refuse_progress(void* data, double fraction) {
    (void)data, (void)fraction;
    return 1;
}

/* Numbers 0 to 1, the same on every machine. */
static float next_number(uint32_t* state) {
    *state = *state * 1664525u + 1013904223u;
    return (float)(*state >> 8) / 16777216.0f;
}

static void make_boxes(float* numbers, uint32_t seed) {
    for (int i = 0; i < COUNT; ++i) {
        for (int axis = 0; axis < 3; ++axis) {
            numbers[6 * i + axis] = next_number(&seed);
            numbers[6 * i + 3 + axis] = numbers[6 * i + axis] + 0.1f * next_number(&seed);
        }
    }
}

static int overlap(const float* a, const float* b, double margin) {
    for (int axis = 0; axis < 3; ++axis) {
        if ((double)a[axis] - b[axis + 3] > margin || (double)b[axis] - a[axis + 3] > margin) return 0;
    }
    return 1;
}

/* Returns the pairs by comparing all boxes; `second` may be NULL. */
static pair_array brute_force(const float* first, const float* second, double margin) {
    pair_array all = {NULL, 0, 0};
    for (uint32_t a = 0; a < COUNT; ++a) {
        for (uint32_t b = second == NULL ? a + 1 : 0; b < COUNT; ++b) {
            if (overlap(first + 6 * a, (second == NULL ? first : second) + 6 * b, margin)) {
                octopair_pair pair;
                pair.a = a;
                pair.b = b;
                collect(&all, &pair, 1);
            }
        }
    }
    return all;
}

static int same(const octopair_pair* pairs, uint64_t count, const pair_array* expected) {
    return count == expected->count &&
           (count == 0 || memcmp(pairs, expected->pairs, expected->count * sizeof *pairs) == 0);
}

static octopair_objects objects_at(const float* numbers) {
    octopair_objects objects = OCTOPAIR_OBJECTS_INIT;
    objects.boxes = numbers;
    objects.count = COUNT;
    return objects;
}

static void test_engine(const char* kind) {
    float numbers[6 * COUNT], others[6 * COUNT];
    octopair_engine* engine = NULL;
    octopair_engine_options engine_options = OCTOPAIR_ENGINE_OPTIONS_INIT;
    octopair_pairs* pairs = NULL;
    octopair_pair* copied;
    octopair_summary summary = OCTOPAIR_SUMMARY_INIT;
    octopair_options options = OCTOPAIR_OPTIONS_INIT;
    octopair_job* job = NULL;
    double progress = 0;
    uint64_t count = 0;
    int ended = 0;

    make_boxes(numbers, 1);
    make_boxes(others, 2);
    const octopair_objects first = objects_at(numbers), second = objects_at(others);
    pair_array within = brute_force(numbers, NULL, 0), between = brute_force(numbers, others, 0.01),
               streamed = {NULL, 0, 0};
    copied = (octopair_pair*)malloc((within.count + between.count + 1) * sizeof *copied);

    engine_options.workers = 2;
    CHECK_OK(octopair_engine_create(kind, &engine_options, &engine));
    if (engine == NULL) return;
    CHECK_OK(octopair_pairs_create(&pairs));

    CHECK_OK(octopair_find_pairs(engine, &first, NULL, NULL, pairs, &summary));
    CHECK(octopair_pairs_count(pairs) == within.count && summary.pairs == within.count && !summary.truncated);
    CHECK(same(copied, octopair_pairs_copy(pairs, 0, copied, within.count), &within));
    CHECK(octopair_pairs_copy(pairs, 3, copied, 2) == 2 && copied[0].a == within.pairs[3].a &&
          copied[1].b == within.pairs[4].b);
    CHECK(octopair_pairs_copy(pairs, within.count, copied, 9) == 0);

    options.margin = 0.01;
    options.verify = 1;
    options.progress = note_progress;
    options.progress_data = &progress;
    CHECK_OK(octopair_stream_pairs(engine, &first, &second, &options, collect, &streamed, &summary));
    CHECK(same(streamed.pairs, streamed.count, &between) && summary.verified && progress == 1);
    CHECK_OK(octopair_count_pairs(engine, &first, &second, &options, &count));
    CHECK(count == between.count);

    options.limit = 5;
    options.verify = 0;
    CHECK_OK(octopair_find_pairs(engine, &first, &second, &options, pairs, &summary));
    CHECK(octopair_pairs_count(pairs) == 5 && summary.truncated);
    CHECK(octopair_stream_pairs(engine, &first, NULL, NULL, refuse, NULL, NULL) == OCTOPAIR_CANCELLED);
    options.progress = refuse_progress;
    CHECK(octopair_find_pairs(engine, &first, NULL, &options, pairs, NULL) == OCTOPAIR_CANCELLED);

    CHECK_OK(octopair_job_submit(engine, &first, NULL, NULL, &job));
    CHECK_OK(octopair_job_wait(job, -1, &ended));
    CHECK(ended == 1 && octopair_job_get_state(job) == OCTOPAIR_JOB_DONE && octopair_job_get_progress(job) == 1);
    CHECK_OK(octopair_job_take_pairs(job, pairs, &summary));
    CHECK(same(copied, octopair_pairs_copy(pairs, 0, copied, within.count), &within));
    CHECK(octopair_job_take_pairs(job, pairs, NULL) == OCTOPAIR_USAGE);
    octopair_job_cancel(job);
    octopair_job_destroy(job);

    numbers[6 * 7] = NAN;
    CHECK(octopair_find_pairs(engine, &first, NULL, NULL, pairs, NULL) == OCTOPAIR_BAD_INPUT);
    CHECK(strstr(octopair_error_message(), "object 7") != NULL && octopair_pairs_count(pairs) == 0);
    uint64_t index = 0;
    uint32_t set = 9;
    CHECK(octopair_error_place(&index, &set) == 1 && index == 7 && set == 0);
    CHECK_OK(octopair_job_submit(engine, &first, NULL, NULL, &job));
    CHECK(octopair_job_take_pairs(job, pairs, NULL) == OCTOPAIR_BAD_INPUT);
    CHECK(octopair_job_get_state(job) == OCTOPAIR_JOB_FAILED);
    octopair_engine_destroy(engine);
    octopair_job_destroy(job);
    octopair_pairs_destroy(pairs);
    free(copied);
    free(within.pairs);
    free(between.pairs);
    free(streamed.pairs);
}

static void test_stop(void) {
    float numbers[6 * COUNT];
    octopair_stop* stop = NULL;
    octopair_engine* engine = NULL;
    octopair_options options = OCTOPAIR_OPTIONS_INIT;
    uint64_t count = 0;
    make_boxes(numbers, 1);
    const octopair_objects objects = objects_at(numbers);
    CHECK_OK(octopair_stop_create(&stop));
    CHECK_OK(octopair_engine_create("local", NULL, &engine));
    options.stop = stop;
    CHECK_OK(octopair_count_pairs(engine, &objects, NULL, &options, &count));
    octopair_stop_request(stop);
    CHECK(octopair_count_pairs(engine, &objects, NULL, &options, &count) == OCTOPAIR_CANCELLED);
    octopair_engine_destroy(engine);
    octopair_stop_destroy(stop);
}

static void test_scene(void) {
    float numbers[6 * COUNT];
    octopair_scene* scene = NULL;
    octopair_scene_options options = OCTOPAIR_SCENE_OPTIONS_INIT;
    octopair_step step = OCTOPAIR_STEP_INIT;
    octopair_id ids[COUNT];
    octopair_traits traits = OCTOPAIR_TRAITS_INIT;
    octopair_answers* answers = NULL;
    const double box[6] = {-1, -1, -1, 2, 2, 2}, ball[4] = {0.5, 0.5, 0.5, 2}, point[6] = {9, 9, 9, 9, 9, 9};
    const double ray[7] = {-1, 0.5, 0.5, 1, 0, 0, INFINITY};
    make_boxes(numbers, 1);
    octopair_objects objects = objects_at(numbers);
    pair_array expected = brute_force(numbers, NULL, 0), found = {NULL, 0, 0};

    CHECK_OK(octopair_scene_create(NULL, &scene));
    CHECK_OK(octopair_scene_add(scene, &objects, NULL, ids));
    CHECK(octopair_scene_count(scene) == COUNT);
    CHECK_OK(octopair_scene_step(scene, NULL, &step));
    CHECK(same(step.began, step.began_count, &expected) && step.ended_count == 0 && step.full);
    CHECK_OK(octopair_scene_pairs(scene, collect, &found));
    CHECK(same(found.pairs, found.count, &expected));

    /* Far away and back: its pairs end, and begin again. */
    const float far_box[6] = {50, 50, 50, 51, 51, 51};
    CHECK_OK(octopair_scene_move(scene, &ids[expected.pairs[0].a], far_box, 1));
    CHECK_OK(octopair_scene_step(scene, NULL, &step));
    CHECK(step.ended_count > 0 && step.began_count == 0 && step.persisting == expected.count - step.ended_count);
    CHECK_OK(octopair_scene_sweep(scene, &ids[expected.pairs[0].a], numbers + 6 * expected.pairs[0].a, 1));
    CHECK_OK(octopair_scene_step(scene, NULL, &step));
    CHECK(step.began_count > 0);
    CHECK_OK(octopair_scene_step(scene, NULL, &step));
    found.count = 0;
    CHECK_OK(octopair_scene_pairs(scene, collect, &found));
    CHECK(same(found.pairs, found.count, &expected));

    CHECK_OK(octopair_answers_create(&answers));
    CHECK_OK(octopair_scene_overlap_boxes(scene, box, 1, OCTOPAIR_ALL_GROUPS, answers));
    CHECK(octopair_answers_queries(answers) == 1 && octopair_answers_offsets(answers)[1] == COUNT);
    CHECK(octopair_answers_indices(answers)[COUNT - 1] == COUNT - 1 && octopair_answers_values(answers) == NULL);
    CHECK_OK(octopair_scene_overlap_balls(scene, ball, 1, OCTOPAIR_ALL_GROUPS, answers));
    CHECK(octopair_answers_offsets(answers)[1] == COUNT);
    CHECK_OK(octopair_scene_nearest(scene, point, 1, COUNT, INFINITY, OCTOPAIR_ALL_GROUPS, answers));
    CHECK(octopair_answers_offsets(answers)[1] == COUNT);
    const double nearest = octopair_answers_values(answers)[0], farthest = octopair_answers_values(answers)[COUNT - 1];
    CHECK(nearest < farthest);
    CHECK_OK(octopair_scene_nearest(scene, point, 1, COUNT, nearest, OCTOPAIR_ALL_GROUPS, answers));
    CHECK(octopair_answers_offsets(answers)[1] >= 1 && octopair_answers_offsets(answers)[1] < COUNT);
    CHECK(octopair_scene_nearest(scene, point, 1, 3, -1, OCTOPAIR_ALL_GROUPS, answers) == OCTOPAIR_BAD_INPUT);
    CHECK_OK(octopair_scene_nearest(scene, point, 1, 3, INFINITY, OCTOPAIR_ALL_GROUPS, answers));
    CHECK(octopair_answers_offsets(answers)[1] == 3);
    CHECK_OK(octopair_scene_hits(scene, ray, 1, 1, OCTOPAIR_ALL_GROUPS, answers));
    const uint64_t hits = octopair_answers_offsets(answers)[1];
    CHECK_OK(octopair_scene_hits(scene, ray, 1, 0, OCTOPAIR_ALL_GROUPS, answers));
    CHECK(octopair_answers_offsets(answers)[1] == (hits > 0 ? 1u : 0u));
    CHECK(octopair_scene_overlap_boxes(scene, NULL, 1, OCTOPAIR_ALL_GROUPS, answers) == OCTOPAIR_BAD_INPUT);

    traits.mask = 0;
    CHECK_OK(octopair_scene_set_traits(scene, &ids[expected.pairs[0].a], &traits, 1));
    CHECK_OK(octopair_scene_step(scene, NULL, &step));
    CHECK(step.ended_count > 0);
    CHECK_OK(octopair_scene_remove(scene, ids, COUNT));
    CHECK(octopair_scene_count(scene) == 0);
    CHECK(octopair_scene_remove(scene, ids, 1) == OCTOPAIR_BAD_INPUT);
    octopair_scene_destroy(scene);

    options.precision = OCTOPAIR_FLOAT64;
    CHECK_OK(octopair_scene_create(&options, &scene));
    CHECK(octopair_scene_add(scene, &objects, NULL, ids) == OCTOPAIR_BAD_INPUT && octopair_scene_count(scene) == 0);
    octopair_scene_destroy(scene);
    options.precision = 7;
    CHECK(octopair_scene_create(&options, &scene) == OCTOPAIR_BAD_INPUT);
    octopair_answers_destroy(answers);
    free(expected.pairs);
    free(found.pairs);
}

static void test_wrong_calls(void) {
    octopair_engine* engine = NULL;
    octopair_objects objects = OCTOPAIR_OBJECTS_INIT;
    octopair_options options = OCTOPAIR_OPTIONS_INIT;
    octopair_pairs* pairs = NULL;
    uint64_t count = 77;
    CHECK(octopair_engine_create("other", NULL, &engine) == OCTOPAIR_USAGE && engine == NULL);
    CHECK(octopair_engine_create(NULL, NULL, &engine) == OCTOPAIR_BAD_INPUT);
    CHECK(strstr(octopair_error_message(), "kind is NULL") != NULL);
    CHECK(octopair_engine_create("local", NULL, NULL) == OCTOPAIR_BAD_INPUT);
    CHECK_OK(octopair_engine_create("local", NULL, &engine));
    CHECK_OK(octopair_pairs_create(&pairs));
    CHECK(octopair_find_pairs(NULL, &objects, NULL, NULL, pairs, NULL) == OCTOPAIR_BAD_INPUT);
    CHECK(octopair_find_pairs(engine, NULL, NULL, NULL, pairs, NULL) == OCTOPAIR_BAD_INPUT);
    CHECK(octopair_find_pairs(engine, &objects, NULL, NULL, NULL, NULL) == OCTOPAIR_BAD_INPUT);
    CHECK_OK(octopair_find_pairs(engine, &objects, NULL, NULL, pairs, NULL)); /* no objects */
    objects.count = 1;
    CHECK(octopair_count_pairs(engine, &objects, NULL, NULL, &count) == OCTOPAIR_BAD_INPUT && count == 77);
    objects.count = 0;
    objects.precision = 2;
    CHECK(octopair_count_pairs(engine, &objects, NULL, NULL, &count) == OCTOPAIR_BAD_INPUT);
    objects.precision = OCTOPAIR_FLOAT64;
    CHECK_OK(octopair_count_pairs(engine, &objects, NULL, NULL, &count));
    options.order = 2;
    CHECK(octopair_count_pairs(engine, &objects, NULL, &options, &count) == OCTOPAIR_BAD_INPUT);
    options.order = OCTOPAIR_OCTAL;
    options.size = 0;
    CHECK(octopair_count_pairs(engine, &objects, NULL, &options, &count) == OCTOPAIR_BAD_INPUT);
    options.size = sizeof options + 8;
    CHECK(octopair_count_pairs(engine, &objects, NULL, &options, &count) == OCTOPAIR_BAD_INPUT);
    options.size = offsetof(octopair_options, limit); /* a program of an older header, without the later members */
    options.limit = 0;
    CHECK_OK(octopair_count_pairs(engine, &objects, NULL, &options, &count));
    CHECK(octopair_stream_pairs(engine, &objects, NULL, NULL, NULL, NULL, NULL) == OCTOPAIR_BAD_INPUT);
    octopair_pairs_destroy(pairs);
    octopair_engine_destroy(engine);
    octopair_pairs_destroy(NULL);
    octopair_engine_destroy(NULL);
    octopair_job_destroy(NULL);
    octopair_scene_destroy(NULL);
    octopair_answers_destroy(NULL);
    octopair_stop_destroy(NULL);
}

/* A call that fails leaves `pairs` empty and does nothing else. Outputs without a size are refused before the work. */
static void test_failed_calls(void) {
    const float boxes[2][6] = {{0, 0, 0, 1, 1, 1}, {1, 0, 0, 2, 1, 1}};
    octopair_engine* engine = NULL;
    octopair_objects objects = OCTOPAIR_OBJECTS_INIT;
    octopair_options wrong = OCTOPAIR_OPTIONS_INIT;
    octopair_summary summary = OCTOPAIR_SUMMARY_INIT;
    octopair_step step = OCTOPAIR_STEP_INIT;
    octopair_pairs* pairs = NULL;
    octopair_job* job = NULL;
    octopair_scene* scene = NULL;
    octopair_id ids[2];
    pair_array found = {NULL, 0, 0};
    objects.boxes = boxes;
    objects.count = 2;
    wrong.order = 9;
    CHECK(octopair_pairs_create(NULL) == OCTOPAIR_BAD_INPUT && octopair_stop_create(NULL) == OCTOPAIR_BAD_INPUT);
    CHECK(octopair_answers_create(NULL) == OCTOPAIR_BAD_INPUT);
    CHECK_OK(octopair_engine_create("local", NULL, &engine));
    CHECK_OK(octopair_pairs_create(&pairs));
    CHECK_OK(octopair_find_pairs(engine, &objects, NULL, NULL, pairs, NULL));
    CHECK(octopair_pairs_count(pairs) == 1);
    CHECK(octopair_find_pairs(engine, &objects, NULL, &wrong, pairs, NULL) == OCTOPAIR_BAD_INPUT);
    CHECK(octopair_pairs_count(pairs) == 0);

    summary.size = 0;
    CHECK(octopair_find_pairs(engine, &objects, NULL, NULL, pairs, &summary) == OCTOPAIR_BAD_INPUT);
    CHECK(octopair_pairs_count(pairs) == 0);
    CHECK(octopair_stream_pairs(engine, &objects, NULL, NULL, collect, &found, &summary) == OCTOPAIR_BAD_INPUT);
    CHECK(found.count == 0);
    CHECK_OK(octopair_job_submit(engine, &objects, NULL, NULL, &job));
    CHECK(octopair_job_take_pairs(job, pairs, &summary) == OCTOPAIR_BAD_INPUT);
    CHECK_OK(octopair_job_take_pairs(job, pairs, NULL));
    CHECK(octopair_pairs_count(pairs) == 1);

    CHECK_OK(octopair_scene_create(NULL, &scene));
    CHECK_OK(octopair_scene_add(scene, &objects, NULL, ids));
    step.size = 0;
    CHECK(octopair_scene_step(scene, NULL, &step) == OCTOPAIR_BAD_INPUT);
    step.size = sizeof step;
    CHECK_OK(octopair_scene_step(scene, NULL, &step));
    CHECK(step.began_count == 1);
    CHECK(octopair_scene_remove(scene, ids, UINT64_MAX) == OCTOPAIR_RESOURCE_LIMIT);
    octopair_scene_destroy(scene);
    octopair_job_destroy(job);
    octopair_pairs_destroy(pairs);
    octopair_engine_destroy(engine);
}

static void test_addresses(int with_servers) {
    octopair_engine* engine = NULL;
    octopair_engine_options options = OCTOPAIR_ENGINE_OPTIONS_INIT;
    options.connect_timeout = 0.1;
    const octopair_status expected = with_servers ? OCTOPAIR_ENGINE_FAILED : OCTOPAIR_USAGE;
    CHECK(octopair_engine_create("unix:/nonexistent/socket", &options, &engine) == expected);
    options.connect_timeout = -1;
    CHECK(octopair_engine_create("unix:/nonexistent/socket", &options, &engine) != OCTOPAIR_OK && engine == NULL);
    CHECK(!with_servers || strstr(octopair_error_message(), "connect_timeout") != NULL);
}

int main(int argc, char** argv) {
    CHECK(strlen(octopair_version()) >= 5 && strcmp(octopair_error_message(), "") == 0);
    test_wrong_calls();
    test_failed_calls();
    test_addresses(argc > 1);
    test_engine("local");
    test_engine("processes");
    if (argc > 1) test_engine(argv[1]);
    test_stop();
    test_scene();
    printf("%d failures\n", failures);
    return failures == 0 ? 0 : 1;
}
