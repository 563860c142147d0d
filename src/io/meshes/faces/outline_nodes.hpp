// OutlineNodes: the corners of an outline in the order of a sweep. Corners at one place of the plane are one node.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "io/meshes/faces/plane_outline.hpp"

namespace octopair::io {

/// An edge between two nodes.
struct OutlineEdge {
    std::uint32_t low, high;   ///< low < high
    int weight;                ///< 1: the outline goes from low to high; -1: from high to low
    std::uint32_t bundle = 0;  ///< set by the sweep
};

/// Nodes are numbered from left to right; those straight above each other, from below.
class OutlineNodes {
public:
    explicit OutlineNodes(const PlaneOutline& outline);

    std::uint32_t size() const { return std::uint32_t(corners_.size()); }
    /// Returns the first corner at a node.
    std::uint32_t corner_of(std::uint32_t node) const { return corners_[node]; }
    std::uint32_t node_of(std::uint32_t corner) const { return nodes_[corner]; }
    /// Returns the places of the nodes' corners.
    const std::vector<Point3d>& places() const { return places_; }

    /// Returns the edges of the outline that are not between two corners of one node.
    std::span<OutlineEdge> edges() { return edges_; }
    /// Return the numbers of the edges with this low or high node.
    std::span<const std::uint32_t> starting_at(std::uint32_t node) const { return starting_.of(node); }
    std::span<const std::uint32_t> ending_at(std::uint32_t node) const { return ending_.of(node); }

private:
    /// Numbers of edges, by a node of theirs.
    struct EdgesByNode {
        std::vector<std::uint32_t> begins, numbers;
        std::span<const std::uint32_t> of(std::uint32_t node) const {
            return std::span(numbers).subspan(begins[node], begins[node + 1] - begins[node]);
        }
    };
    EdgesByNode by_node(std::uint32_t OutlineEdge::*end) const;

    std::vector<std::uint32_t> corners_, nodes_;
    std::vector<Point3d> places_;
    std::vector<OutlineEdge> edges_;
    EdgesByNode starting_, ending_;
};

}  // namespace octopair::io
