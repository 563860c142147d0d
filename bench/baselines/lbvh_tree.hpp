// A linear bounding volume hierarchy in pre-order. Internal to the baselines.
//
// Invariants: a tree over m leaves has 2 m - 1 nodes; the left child of node i is node i + 1; node i and all below it
// are nodes [i, escape). Leaves come in the order of their Morton codes. So the nodes from `escape` of a leaf on hold
// exactly the leaves that come after it.
//
// Sources: Lauterbach et al. 2009, "Fast BVH Construction on GPUs"; Karras 2012 (splits at the highest differing bit);
// Prokopenko, Lebrun-Grandie 2024 on ArborX (escape links, half traversal).
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "octopair/objects.hpp"

namespace octopair::baselines {

struct LbvhNode {
    Box3f box;
    std::uint32_t escape;  ///< the first node behind this one's subtree
    std::uint32_t object;  ///< of a leaf; no_object for an inner node

    static constexpr std::uint32_t no_object = 0xffffffff;
};

/// Builds with the threads of the arena it is called in. At most 2^31 - 1 boxes.
std::vector<LbvhNode> build_lbvh(std::span<const Box3f> boxes);

}  // namespace octopair::baselines
