/* Finds the pairs of three boxes from C. Build it with: cc find_pairs.c $(pkg-config --cflags --libs octopair-c) */
#include <octopair.h>
#include <stdio.h>

static int print_pairs(void *data, const octopair_pair *pairs, size_t count) {
    (void)data;
    for (size_t i = 0; i < count; ++i) printf("%u and %u\n", (unsigned)pairs[i].a, (unsigned)pairs[i].b);
    return 0;
}

int main(void) {
    const float boxes[3][6] = {{0, 0, 0, 1, 1, 1}, {5, 5, 5, 6, 6, 6}, {1, 0, 0, 2, 1, 1}}; /* 0 and 2 touch */
    octopair_objects objects = OCTOPAIR_OBJECTS_INIT;
    octopair_engine *engine = NULL;
    objects.boxes = boxes;
    objects.count = 3;
    if (octopair_engine_create("local", NULL, &engine) != OCTOPAIR_OK ||
        octopair_stream_pairs(engine, &objects, NULL, NULL, print_pairs, NULL, NULL) != OCTOPAIR_OK) {
        fprintf(stderr, "%s\n", octopair_error_message());
    }
    octopair_engine_destroy(engine);
    return 0;
}
