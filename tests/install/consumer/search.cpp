// A library that finds pairs on either engine. The choice is a single line.
#include <octopair/octopair.hpp>
#include <octopair/processes.hpp>

#include <cstddef>
#include <vector>

std::size_t pairs_among(unsigned objects) {
    std::vector<octopair::Box3f> boxes;
    for (unsigned i = 0; i < objects; ++i) boxes.push_back({{float(i), 0, 0}, {float(i) + 1, 1, 1}});  // touch the next
    octopair::PairList pairs;
    octopair::make_process_engine(2)->find_pairs({boxes}, pairs);
    return pairs.size();
}
