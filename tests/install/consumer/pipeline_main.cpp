// A program that passes three boxes through a custom filter and a filter of octopair.
#include <octopair/filters.hpp>
#include <octopair/octopair.hpp>

#include <cstdio>

int main() {
    try {
        const std::vector<octopair::Box3f> boxes(3, {{0, 0, 0}, {1, 1, 1}});
        octopair::Pipeline pipeline;
        pipeline.add(octopair::make_ignored_pairs_filter({{1, 0}}));
        pipeline.add(octopair::make_filter("not last", [](octopair::Pair pair) { return pair.a != 1; }));
        std::vector<octopair::Pair> found;
        pipeline.run(*octopair::make_local_engine(), {boxes}, [&](const octopair::Batch& batch) {
            found.insert(found.end(), batch.pairs().begin(), batch.pairs().end());
        });
        return found == std::vector<octopair::Pair>{{0, 2}} ? 0 : 1;
    } catch (const octopair::Error& error) {
        std::fprintf(stderr, "%s\n", error.what());
        return 1;
    }
}
