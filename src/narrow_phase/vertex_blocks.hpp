// VertexBlocks: vertices in blocks of neighbours. Finds the extreme vertices along an axis without reading all vertices.
//
// Cost      Without blocks, the world boxes of all instances of a mesh would cost instances x vertices.
// Skipping  The vertices of a block are read only if its box, widened by the rounding error, exceeds the bounds found so far.
// Exact     The result is that of reading every vertex.
#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "octopair/objects.hpp"
#include "octopair/pose.hpp"

namespace octopair {

class VertexBlocks {
public:
    VertexBlocks() = default;
    explicit VertexBlocks(std::vector<Point3d> vertices);

    bool empty() const { return blocks_.empty(); }

    /// Returns the bounds of the vertices in the world (vector::posed); not finite if a coordinate is beyond float64.
    /// Requires: !empty().
    Box3d world_box(const Pose& pose) const;

private:
    static constexpr std::size_t block_size = 32;
    struct Block {
        Point3d centre, half;
    };
    using Places = std::array<std::array<double, block_size>, 3>;  ///< by axis; padded with the last vertex

    struct Row;
    void extend_by_block(std::size_t block, const Row& row, double& low, double& high) const;

    std::vector<Block> blocks_;  // separate from places_: a search reads all blocks, but the vertices of few blocks
    std::vector<Places> places_;
    Point3d largest_ = {};  ///< largest absolute coordinate on each axis
};

}  // namespace octopair
