// A library that finds pairs with worker processes. A single line chooses the engine.
#include <octopair/octopair.hpp>
#include <octopair/processes.hpp>

#include <cstddef>
#include <vector>

std::size_t pairs_among(unsigned objects) {
    std::vector<octopair::Box3f> boxes;
    // Each box touches the next.
    for (unsigned i = 0; i < objects; ++i) boxes.push_back({{float(i), 0, 0}, {float(i) + 1, 1, 1}});
    octopair::PairList pairs;
    octopair::make_process_engine(2)->find_pairs({boxes}, pairs);
    return pairs.size();
}
