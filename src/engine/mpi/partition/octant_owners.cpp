#include "engine/mpi/partition/octant_owners.hpp"

#include <algorithm>

#include "engine/mpi/partition/even_cuts.hpp"

namespace octopair {

OctantOwners::OctantOwners(std::span<const std::uint64_t> work, unsigned ranks)
    : begins_(least_cuts(work, ranks)), owners_(work.size()) {
    for (unsigned rank = 0; rank < ranks; ++rank) {
        std::fill(owners_.begin() + begin(rank), owners_.begin() + end(rank), rank);
    }
}

}  // namespace octopair
