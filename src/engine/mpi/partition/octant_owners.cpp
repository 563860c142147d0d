#include "engine/mpi/partition/octant_owners.hpp"

#include <algorithm>
#include <numeric>
#include <utility>

#include "engine/mpi/partition/even_cuts.hpp"

namespace octopair {

OctantOwners::OctantOwners(std::span<const std::uint64_t> work, unsigned ranks)
    : begins_(least_cuts(work, ranks)), owners_(work.size()), octants_(work.size()) {
    std::iota(octants_.begin(), octants_.end(), OctantIndex(0));
    for (unsigned rank = 0; rank < ranks; ++rank) {
        std::fill(owners_.begin() + begin(rank), owners_.begin() + end(rank), rank);
    }
}

OctantOwners::OctantOwners(std::vector<std::uint32_t> owners, unsigned ranks)
    : begins_(ranks + 1, 0), owners_(std::move(owners)), octants_(owners_.size()) {
    for (const std::uint32_t rank : owners_) ++begins_[rank + 1];
    std::partial_sum(begins_.begin(), begins_.end(), begins_.begin());
    std::vector<std::size_t> next = begins_;
    for (OctantIndex octant = 0; octant < octants_.size(); ++octant) octants_[next[owners_[octant]]++] = octant;
}

}  // namespace octopair
