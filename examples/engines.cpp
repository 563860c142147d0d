// One search on threads of this process or on worker processes. Only one line selects the engine.
//
//     engines [local|processes ...]      default: both
#include <octopair/octopair.hpp>
#include <octopair/processes.hpp>

#include <cstdio>
#include <memory>
#include <string>
#include <vector>

namespace {

/// Makes the engine. All other code of this program uses only the interface Engine.
std::unique_ptr<octopair::Engine> make_engine(const std::string& name) {
    return name == "processes" ? octopair::make_process_engine(2) : octopair::make_local_engine(2);
}

/// Returns a row of unit boxes; every third box touches the next.
std::vector<octopair::Box3f> make_boxes(unsigned count) {
    std::vector<octopair::Box3f> boxes;
    for (unsigned i = 0; i < count; ++i) {
        const float x = 2 * float(i) - (i % 3 == 1 ? 1.0f : 0.0f);
        boxes.push_back({{x, 0, 0}, {x + 1, 1, 1}});
    }
    return boxes;
}

std::vector<octopair::Pair> search(const std::string& name, const std::vector<octopair::Box3f>& boxes) {
    const auto engine = make_engine(name);
    octopair::PairList pairs;
    engine->find_pairs({boxes}, pairs);
    std::printf("%s:", name.c_str());
    for (const auto [a, b] : pairs.to_vector()) std::printf(" %u and %u", a, b);
    std::printf("\n");
    return pairs.to_vector();
}

}  // namespace

int main(int count, char** words) {
    std::vector<std::string> names(words + 1, words + count);
    if (names.empty()) names = {"local", "processes"};
    const std::vector<octopair::Box3f> boxes = make_boxes(9);
    try {
        const std::vector<octopair::Pair> expected = search(names.front(), boxes);
        for (const std::string& name : names) {
            if (name == names.front()) continue;
            std::printf("%s\n", search(name, boxes) == expected ? "the same pairs" : "other pairs");
        }
    } catch (const octopair::Error& error) {
        std::fprintf(stderr, "%s\n", error.what());
        return 1;
    }
}
