// VertexBlocks: points in blocks of neighbours, so that the extreme ones are found without a look at all.
//
// World boxes of many instances of one mesh would cost instances x vertices. A block is looked into only if its box, with
// what rounding may add, reaches beyond what was found before; the result is exactly that of a look at every vertex.
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

    /// The bounds of the vertices where a pose puts them (vector::posed); not finite where these are beyond float64.
    /// Not empty.
    Box3d world_box(const Pose& pose) const;

private:
    static constexpr std::size_t block_size = 32;
    struct Block {
        Point3d centre, half;
    };
    using Places = std::array<std::array<double, block_size>, 3>;  ///< by axis; the last one is repeated

    struct Row;
    void look_into(std::size_t block, const Row& row, double& low, double& high) const;

    std::vector<Block> blocks_;  // apart from what is in them: all are looked at, few looked into
    std::vector<Places> places_;
    Point3d largest_ = {};  ///< of each axis, the largest absolute coordinate
};

}  // namespace octopair
