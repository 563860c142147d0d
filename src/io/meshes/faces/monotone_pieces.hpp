// MonotonePieces: the open pieces of an outline's inside while a line sweeps over the outline, and the triangles cut off them.
//
// - A gap is the inside between two neighbours among the edges that the line crosses. It has one piece; or two pieces, one above the
//   other, from a node where two gaps have become one until the next node of the gap.
// - A piece is bounded below and above by chains of nodes that go to the right. Triangles are cut off as soon as possible. What is left
//   is a chain of nodes, none of which can be cut off, on one side, and a single edge on the other side. The first node of the chain is
//   where this edge begins.
// - Nodes are given in their order from left to right; those straight above each other, from below.
//
// Source: Garey, Johnson, Preparata, Tarjan, "Triangulating a simple polygon", 1978, with the split into monotone pieces in the same sweep.
#pragma once

#include <array>
#include <cstdint>
#include <utility>
#include <vector>

#include "io/meshes/faces/plane_outline.hpp"

namespace octopair::io {

class MonotonePieces {
public:
    static constexpr std::uint32_t none = ~std::uint32_t(0);
    enum class Side : std::uint8_t { lower, upper };
    struct Gap {
        std::uint32_t lower = none;  ///< number of the only or the lower piece; none: the gap is not inside
        std::uint32_t upper = none;  ///< number of the upper piece, if there are two
        bool is_inside() const { return lower != none; }
    };

    /// Borrows both. Appends triangles to `triangles`, counterclockwise in the plane.
    MonotonePieces(const PlaneOutline& outline, std::vector<std::array<std::uint32_t, 3>>& triangles)
        : outline_(outline), triangles_(triangles) {}

    // The following functions add `node` to a gap. All require a gap that is inside.

    /// Returns a new gap that begins at the node.
    Gap open(std::uint32_t node);
    /// The gap ends at the node.
    void close(const Gap& gap, std::uint32_t node);
    /// Returns the gap, after its lower or upper edge ended at the node.
    Gap extend(const Gap& gap, std::uint32_t node, Side side);
    /// Returns the gaps below and above the node, which is within the gap.
    std::pair<Gap, Gap> split(const Gap& gap, std::uint32_t node);
    /// Returns the gap that two gaps become, after both were extended by the node where the edges between them end.
    static Gap merge(const Gap& lower, const Gap& upper) { return {lower.lower, upper.lower}; }

private:
    struct Piece {
        std::vector<std::uint32_t> chain;
        Side side = Side::lower;  // of all nodes of the chain but the first
    };

    std::uint32_t add_piece(Piece piece);
    void extend_piece(std::uint32_t number, std::uint32_t node, Side side);
    void close_piece(std::uint32_t number, std::uint32_t node);
    void cut_fan(const Piece& piece, std::uint32_t node);
    void cut(Side side, std::uint32_t first, std::uint32_t second, std::uint32_t third);

    const PlaneOutline& outline_;
    std::vector<std::array<std::uint32_t, 3>>& triangles_;
    std::vector<Piece> pieces_;
    std::vector<std::uint32_t> closed_;  // numbers of pieces that are free
};

}  // namespace octopair::io
