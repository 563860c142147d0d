#include "baselines/lbvh_tree.hpp"

#include <tbb/parallel_for.h>
#include <tbb/parallel_invoke.h>
#include <tbb/parallel_sort.h>

#include <algorithm>
#include <array>
#include <bit>
#include <limits>

namespace octopair::baselines {

namespace {

struct MortonLeaf {
    std::uint64_t code;
    std::uint32_t object;
    bool operator<(const MortonLeaf& other) const {
        return code != other.code ? code < other.code : object < other.object;
    }
};

/// Returns the low 21 bits of `x`, with two zeros before each bit.
std::uint64_t spread_bits(std::uint64_t x) {
    x = (x | x << 32) & 0x001f00000000ffffu;
    x = (x | x << 16) & 0x001f0000ff0000ffu;
    x = (x | x << 8) & 0x100f00f00f00f00fu;
    x = (x | x << 4) & 0x10c30c30c30c30c3u;
    x = (x | x << 2) & 0x1249249249249249u;
    return x;
}

/// Returns twice the centre, on each axis.
std::array<double, 3> doubled_centre(const Box3f& box) {
    std::array<double, 3> sum;
    for (unsigned axis = 0; axis < 3; ++axis) sum[axis] = double(box.min[axis]) + double(box.max[axis]);
    return sum;
}

/// Maps the centres of all boxes to cells of a grid with 2^21 cells per axis.
class MortonGrid {
public:
    explicit MortonGrid(std::span<const Box3f> boxes) {
        origin_.fill(std::numeric_limits<double>::infinity());
        std::array<double, 3> last;
        last.fill(-std::numeric_limits<double>::infinity());
        for (const Box3f& box : boxes) {
            const auto centre = doubled_centre(box);
            for (unsigned axis = 0; axis < 3; ++axis) {
                origin_[axis] = std::min(origin_[axis], centre[axis]);
                last[axis] = std::max(last[axis], centre[axis]);
            }
        }
        for (unsigned axis = 0; axis < 3; ++axis) {
            const double extent = last[axis] - origin_[axis];
            scale_[axis] = extent > 0 ? max_cell / extent : 0;
        }
    }

    std::uint64_t code(const Box3f& box) const {
        const auto centre = doubled_centre(box);
        std::uint64_t code = 0;
        for (unsigned axis = 0; axis < 3; ++axis) {
            const double cell = std::min((centre[axis] - origin_[axis]) * scale_[axis], max_cell);
            code |= spread_bits(std::uint64_t(cell)) << axis;
        }
        return code;
    }

private:
    static constexpr double max_cell = (1 << 21) - 1;
    std::array<double, 3> origin_, scale_;
};

Box3f joined(const Box3f& a, const Box3f& b) {
    Box3f box;
    for (int axis = 0; axis < 3; ++axis) {
        box.min[axis] = std::min(a.min[axis], b.min[axis]);
        box.max[axis] = std::max(a.max[axis], b.max[axis]);
    }
    return box;
}

class Builder {
public:
    Builder(std::span<const Box3f> boxes, std::span<const MortonLeaf> leaves, std::span<LbvhNode> nodes)
        : boxes_(boxes), leaves_(leaves), nodes_(nodes) {}

    /// Makes node `node` the root of leaves [first, last).
    void build(std::uint32_t node, std::uint32_t first, std::uint32_t last) const {
        if (last - first == 1) {
            const std::uint32_t object = leaves_[first].object;
            nodes_[node] = {boxes_[object], node + 1, object};
            return;
        }
        const std::uint32_t middle = split(first, last);
        const std::uint32_t left = node + 1, right = left + 2 * (middle - first) - 1;
        const auto build_left = [&] { build(left, first, middle); };
        const auto build_right = [&] { build(right, middle, last); };
        if (last - first > leaves_of_a_task) {
            tbb::parallel_invoke(build_left, build_right);
        } else {
            build_left();
            build_right();
        }
        nodes_[node] = {joined(nodes_[left].box, nodes_[right].box), node + 2 * (last - first) - 1,
                        LbvhNode::no_object};
    }

private:
    static constexpr std::uint32_t leaves_of_a_task = 4096;

    /// Returns the first leaf with the highest differing bit of the codes set, or the middle if all codes are equal.
    std::uint32_t split(std::uint32_t first, std::uint32_t last) const {
        const std::uint64_t difference = leaves_[first].code ^ leaves_[last - 1].code;
        if (difference == 0) return first + (last - first) / 2;
        const std::uint64_t bit = std::bit_floor(difference);
        const auto is_below = [&](const MortonLeaf& leaf) { return (leaf.code & bit) == 0; };
        const auto found = std::partition_point(leaves_.begin() + first, leaves_.begin() + last, is_below);
        return std::uint32_t(found - leaves_.begin());
    }

    std::span<const Box3f> boxes_;
    std::span<const MortonLeaf> leaves_;
    std::span<LbvhNode> nodes_;
};

}  // namespace

std::vector<LbvhNode> build_lbvh(std::span<const Box3f> boxes) {
    if (boxes.empty()) return {};
    const MortonGrid grid(boxes);
    std::vector<MortonLeaf> leaves(boxes.size());
    tbb::parallel_for(std::size_t(0), boxes.size(), [&](std::size_t i) {
        leaves[i] = {grid.code(boxes[i]), std::uint32_t(i)};
    });
    tbb::parallel_sort(leaves.begin(), leaves.end());
    std::vector<LbvhNode> nodes(2 * boxes.size() - 1);
    Builder(boxes, leaves, nodes).build(0, 0, std::uint32_t(boxes.size()));
    return nodes;
}

}  // namespace octopair::baselines
