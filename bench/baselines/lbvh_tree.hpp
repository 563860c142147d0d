// Linear bounding volume hierarchy in pre-order. Internal to the baselines.
//
// Invariants:
// - A tree over m leaves has 2 m - 1 nodes.
// - The left child of node i is node i + 1.
// - Node i and all its descendants are nodes [i, escape).
// - Leaves are in the order of their Morton codes, so the nodes from `escape` of a leaf on hold exactly the later leaves.
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
    std::uint32_t escape;  ///< first node after the subtree of this node
    std::uint32_t object;  ///< object of a leaf; no_object for an inner node

    static constexpr std::uint32_t no_object = 0xffffffff;
};

/// Builds the tree with the threads of the calling arena. Requires: at most 2^31 - 1 boxes.
std::vector<LbvhNode> build_lbvh(std::span<const Box3f> boxes);

}  // namespace octopair::baselines
