// Loop that continues during a search: submits a job, polls the job, and takes the pairs after the end.
#include <octopair/octopair.hpp>

#include <chrono>
#include <cinttypes>
#include <cstdio>
#include <cstdlib>
#include <utility>

namespace {

/// Returns cubes in a row: each touches the next.
octopair::BoxArray<octopair::Box3f> row_of_cubes(octopair::Engine& engine, std::uint64_t count) {
    auto array = engine.allocate_boxes(count);  // a std::vector of boxes is possible, too
    float x = 0;
    for (octopair::Box3f& box : array.boxes()) {
        box = {{x, 0, 0}, {x + 1, 1, 1}};
        x += 1;
    }
    return array;
}

/// Work of the loop: a ball that falls and bounces.
struct Ball {
    double height = 1, speed = 0;

    void advance(double seconds) {
        speed -= 9.81 * seconds;
        height += speed * seconds;
        if (height < 0 && speed < 0) speed = -speed;
    }
};

}  // namespace

int main() {
    try {
        const auto engine = octopair::make_local_engine();
        octopair::Job job = engine->submit(row_of_cubes(*engine, 100'000));  // the job now owns the boxes

        Ball ball;
        std::uint64_t frames = 0;
        do {
            ball.advance(1e-3);
            ++frames;
        } while (!job.wait_for(std::chrono::milliseconds(1)));  // job.cancel() would end the job earlier
        std::printf("%" PRIu64 " frames meanwhile\n", frames);

        const octopair::PairList pairs = job.take_pairs();  // throws the job's Error if the job failed
        std::printf("%" PRIu64 " pairs\n", pairs.size());
    } catch (const octopair::Error& error) {
        std::fprintf(stderr, "%s\n", error.what());
        return EXIT_FAILURE;
    }
}
