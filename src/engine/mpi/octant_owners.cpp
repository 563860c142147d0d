#include "engine/mpi/octant_owners.hpp"

#include <algorithm>

#include "engine/mpi/even_cuts.hpp"

namespace octopair {

OctantOwners::OctantOwners(const Directory& directory, std::span<const std::uint64_t> work, unsigned ranks)
    : directory_(directory), begins_(even_cuts(work, ranks)), owners_(work.size()) {
    for (unsigned rank = 0; rank < ranks; ++rank) {
        std::fill(owners_.begin() + begin(rank), owners_.begin() + end(rank), rank);
    }
}

}  // namespace octopair
