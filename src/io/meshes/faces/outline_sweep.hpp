// cut_by_sweep(): cuts the inside of an outline into triangles, also of an outline that touches itself.
//
// - Corners at one place of the plane are one node. An edge that touches a node between its ends is divided there. Edges along each
//   other are one bundle, with the sum of their directions as its weight.
// - A vertical line sweeps over the plane from left to right, and over nodes above each other upward. The bundles that the line crosses are
//   sorted from below. The winding number above a bundle is the number below the bundle, plus the bundle's weight.
// - All winding numbers of an outline that does not cross itself are 0 or 1 (0 or -1, if it is clockwise). Its inside is where they
//   are not 0. Pairs of edges there and back, such as bridges to holes, have the weight 0, and divide the inside.
// - Each new pair of neighbours on the line is tested for a crossing. So the first crossing is found before the line reaches it.
// - All edges of triangles cancel except those of the outline: the mesh of a closed surface stays closed. Where an edge is divided,
//   triangles without area lie between the edge and its parts. If corners are at one place of the plane, but not of space, triangles
//   without area in the plane join them.
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

/// Appends the triangles of an outline, as positions of its corners. They turn the same way as the outline. Returns false if the outline
/// crosses itself or folds; then the function appends nothing.
/// Throws: Error{cancelled}.
bool cut_by_sweep(const PlaneOutline& outline, std::vector<std::array<std::uint32_t, 3>>& triangles);

/// The open pieces of an outline's inside while a line sweeps over the outline, and the triangles cut off them.
///
/// - A gap is the part of the inside between two neighbouring edges on the line. A gap has one piece. Where two gaps become one, the gap
///   has two pieces, one above the other, until its next node.
/// - Chains of nodes bound a piece below and above. Triangles are cut off as soon as possible. The rest of the piece has a chain of nodes
///   on one side, none of which can be cut off, and a single edge on the other side. The edge begins at the first node of the chain.
/// - Callers pass nodes from left to right; nodes straight above each other from below.
class MonotonePieces {
public:
    static constexpr std::uint32_t none = ~std::uint32_t(0);
    enum class Side : std::uint8_t { lower, upper };
    struct Gap {
        std::uint32_t lower = none;  ///< number of the only or the lower piece; none: the gap is not inside
        std::uint32_t upper = none;  ///< number of the upper piece, if there are two
        bool is_inside() const { return lower != none; }
    };

    /// Borrows both arguments. Appends triangles to `triangles`, counterclockwise in the plane.
    MonotonePieces(const PlaneOutline& outline, std::vector<std::array<std::uint32_t, 3>>& triangles)
        : outline_(outline), triangles_(triangles) {}

    // The following functions add `node` to a gap. Requires: the gap is inside the outline.

    /// Returns a new gap that begins at the node.
    Gap open(std::uint32_t node);
    /// Ends a gap at the node.
    void close(const Gap& gap, std::uint32_t node);
    /// Returns the gap with the node, where its lower or upper edge ended.
    Gap extend(const Gap& gap, std::uint32_t node, Side side);
    /// Returns the two gaps, below and above the node, into which the node divides the gap. Requires: the node is within the gap.
    std::pair<Gap, Gap> split(const Gap& gap, std::uint32_t node);
    /// Returns the gap that two gaps become at the node where the edges between them end. Requires: extend() added this node to both.
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
    std::vector<std::uint32_t> closed_;  // numbers of closed pieces, for reuse
};

}  // namespace octopair::io
