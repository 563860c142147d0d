// cut_by_sweep(): cuts the inside of an outline into triangles, also of an outline that touches itself.
//
// - Corners at one place of the plane are one node. An edge that touches a node between its ends is divided there. Edges along each
//   other are one bundle, with the sum of their directions as its weight.
// - A line sweeps over the plane from left to right, and over each vertical line upward. The bundles that it crosses are in their order
//   from below. The winding number of the place above a bundle is that below plus the weight.
// - All winding numbers of an outline that does not cross itself are 0 or 1 (0 or -1, if it is clockwise). Its inside is where they
//   are not 0. Edges there and back, such as bridges to holes, have the weight 0, and divide the inside.
// - Neighbours on the line are tested as in the search for crossings of segments, so the first crossing is found before its place.
// - The triangles' edges cancel except those of the outline: the mesh of a closed surface stays closed. Where an edge is divided,
//   triangles without area lie between it and its parts. Corners at one place of the plane, but not of space, are joined by triangles
//   without area in the plane.
//
// Complexity: O(n log n) for n corners.
// Source: Shamos, Hoey, "Geometric intersection problems", 1976, for the crossings. Garey, Johnson, Preparata, Tarjan, "Triangulating a
// simple polygon", 1978, for the triangles, with the split into monotone pieces in the same sweep.
#pragma once

#include <array>
#include <cstdint>
#include <utility>
#include <vector>

#include "io/meshes/faces/plane_outline.hpp"

namespace octopair::io {

/// Appends the triangles of an outline, by the positions of its corners, in the sense of the outline. Returns false if the outline
/// crosses itself or folds; then it appends nothing.
/// Throws: Error{cancelled}.
bool cut_by_sweep(const PlaneOutline& outline, std::vector<std::array<std::uint32_t, 3>>& triangles);

/// The open pieces of an outline's inside while a line sweeps over the outline, and the triangles cut off them.
///
/// - A gap is the inside between two neighbours among the edges that the line crosses. It has one piece; or two pieces, one above the
///   other, from a node where two gaps have become one until the next node of the gap.
/// - A piece is bounded below and above by chains of nodes that go to the right. Triangles are cut off as soon as possible. What is left
///   is a chain of nodes, none of which can be cut off, on one side, and a single edge on the other side. The first node of the chain is
///   where this edge begins.
/// - Nodes are given in their order from left to right; those straight above each other, from below.
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
        Side side = Side::lower;  // side of all nodes of the chain but the first
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
