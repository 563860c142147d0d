// Calls of box_intersection_d and its relatives. calls.cpp is compiled twice: with CGAL's headers and with those of the adapter.
#pragma once

#include <cstddef>
#include <string>
#include <utility>
#include <vector>

namespace octopair::test {

struct Corners {
    double min[3], max[3];
};

/// Arguments of a call. `second` is the second sequence of calls with two.
struct Question {
    std::vector<Corners> first, second;
    bool closed = true;
    std::ptrdiff_t cutoff = 10;
};

/// Positions of intersecting boxes, sorted. Within one sequence the smaller position is first.
using Positions = std::vector<std::pair<std::size_t, std::size_t>>;

/// A way to call the functions.
struct Call {
    std::string name;
    Positions (*answer)(const Question&);
};

namespace with_cgal {
std::vector<Call> calls();
}
namespace with_octopair {
std::vector<Call> calls();
}

}  // namespace octopair::test
