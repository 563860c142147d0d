// Finds the pairs of three boxes, two of which touch, with each engine of the package.
#include <octopair/octopair.hpp>

#include <cstdio>
#include <vector>

#ifdef WITH_PIPELINE
#include <octopair/filters.hpp>
#endif
#ifdef WITH_PROCESSES
#include <octopair/processes.hpp>
#endif
#ifdef WITH_CLIENT
#include <octopair/client.hpp>
#endif
#ifdef WITH_VIEWER
#include <octopair/view.hpp>
#endif

namespace {

const std::vector<octopair::Box3f> boxes = {{{0, 0, 0}, {1, 1, 1}}, {{5, 5, 5}, {6, 6, 6}}, {{1, 0, 0}, {2, 1, 1}}};
const std::vector<octopair::Pair> expected = {{0, 2}};

bool works(octopair::Engine& engine) {
    octopair::PairList pairs;
    engine.find_pairs({boxes}, pairs);
    return pairs.to_vector() == expected;
}

#ifdef WITH_PIPELINE
bool pipeline_works() {
    octopair::Pipeline pipeline;
    pipeline.add(octopair::make_ignored_pairs_filter({{0, 2}}));
    std::size_t found = 0;
    pipeline.run(*octopair::make_local_engine(), {boxes},
                 [&](const octopair::Batch& batch) { found += batch.pairs().size(); });
    return found == 0;
}
#endif

#ifdef WITH_CLIENT
// The address is refused before a connection is made, so this needs no server.
bool client_works() {
    try {
        octopair::connect("nowhere");
        return false;
    } catch (const octopair::Error&) {
        return true;
    }
}
#endif

#ifdef WITH_VIEWER
bool viewer_works() {
    octopair::Scene scene;
    octopair::View view(scene);
    view.show(scene.step());
    return view.address().starts_with("http://");
}
#endif

bool all_work() {
    bool good = works(*octopair::make_local_engine());
#ifdef WITH_PIPELINE
    good = pipeline_works() && good;
#endif
#ifdef WITH_PROCESSES
    good = works(*octopair::make_process_engine(2)) && good;
#endif
#ifdef WITH_CLIENT
    good = client_works() && good;
#endif
#ifdef WITH_VIEWER
    good = viewer_works() && good;
#endif
    return good;
}

}  // namespace

int main() {
    try {
        const bool good = all_work();
        std::puts(good ? "all libraries of the package work" : "a library of the package has wrong pairs");
        return good ? 0 : 1;
    } catch (const octopair::Error& error) {
        std::fprintf(stderr, "%s\n", error.what());
        return 1;
    }
}
