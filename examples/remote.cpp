// Loop at 60 Hz with pairs from a server. The loop never waits for the server, and takes each result in the first frame
// after the result has arrived.
//
//     octopair serve --listen unix:octopair.socket &
//     remote unix:octopair.socket [OBJECTS [FRAMES]]
#include <octopair/client.hpp>
#include <octopair/octopair.hpp>

#include <chrono>
#include <cinttypes>
#include <cstdio>
#include <cstdlib>
#include <thread>
#include <vector>

namespace {

using Clock = std::chrono::steady_clock;

constexpr std::chrono::microseconds frame_time(16'667);

/// Returns cubes in a row: each touches the next.
std::vector<octopair::Box3f> row_of_cubes(std::uint64_t count) {
    std::vector<octopair::Box3f> boxes(count);
    float x = 0;
    for (octopair::Box3f& box : boxes) {
        box = {{x, 0, 0}, {x + 1, 1, 1}};
        x += 1;
    }
    return boxes;
}

}  // namespace

int main(int count, char** words) {
    const std::uint64_t objects = count > 2 ? std::strtoull(words[2], nullptr, 10) : 1'000'000;
    const std::uint64_t frames = count > 3 ? std::strtoull(words[3], nullptr, 10) : 120;
    try {
        const auto engine = octopair::connect(count > 1 ? words[1] : "unix:octopair.socket");
        const std::vector<octopair::Box3f> boxes = row_of_cubes(objects);
        const auto scene = octopair::borrowed({std::span<const octopair::Box3f>(boxes)});

        octopair::Job job = engine->submit(scene);  // a thread of the engine sends the boxes to the server
        std::uint64_t results = 0, pairs = 0, missed = 0;
        auto next = Clock::now();
        for (std::uint64_t frame = 0; frame < frames || results == 0; ++frame) {
            if (job.wait_for(std::chrono::seconds(0))) {  // true if the job has ended
                pairs = job.take_pairs().size();
                ++results;
                job = engine->submit(scene);
            }
            // Here the application would move and draw its objects.
            next += frame_time;
            if (Clock::now() > next) ++missed;
            std::this_thread::sleep_until(next);
        }
        std::printf("%" PRIu64 " frames, %" PRIu64 " missed, %" PRIu64 " results of %" PRIu64 " pairs\n", frames,
                    missed, results, pairs);
    } catch (const octopair::Error& error) {
        std::fprintf(stderr, "%s\n", error.what());
        return EXIT_FAILURE;
    }
}
