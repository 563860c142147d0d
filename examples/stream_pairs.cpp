// More pairs than fit into memory: one engine for many calls, pairs counted and streamed through a bounded buffer.
#include <octopair/octopair.hpp>

#include <cinttypes>
#include <cstdio>
#include <cstdlib>
#include <vector>

int main() {
    const std::vector<octopair::Box3d> boxes(1000, {{0, 0, 0}, {1, 1, 1}});  // equal boxes: all of them are pairs
    octopair::Options options;
    options.buffer_bytes = 1 << 20;
    try {
        const auto engine = octopair::make_local_engine();
        std::printf("%" PRIu64 " pairs\n", engine->count_pairs({boxes}, options));

        std::uint64_t received = 0;
        engine->stream_pairs(
            {boxes}, [&](auto batch) { received += batch.size(); }, options);
        std::printf("%" PRIu64 " received\n", received);
    } catch (const octopair::Error& error) {
        std::fprintf(stderr, "%s\n", error.what());
        return EXIT_FAILURE;
    }
}
