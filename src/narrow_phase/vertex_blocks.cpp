#include "narrow_phase/vertex_blocks.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>

#include "geometry/vector.hpp"

namespace octopair {
namespace {

struct CornerBounds {
    Point3d low, high;
};

CornerBounds corner_bounds_of(std::span<const Point3d> points) {
    CornerBounds bounds = {points.front(), points.front()};
    for (const Point3d& point : points) {
        for (std::size_t axis = 0; axis < 3; ++axis) {
            bounds.low[axis] = std::min(bounds.low[axis], point[axis]);
            bounds.high[axis] = std::max(bounds.high[axis], point[axis]);
        }
    }
    return bounds;
}

/// Reorders points so that each block holds neighbours: recursively halves the points along the longest side of their bounds.
void arrange(std::span<Point3d> points, std::size_t block_size) {
    if (points.size() <= block_size) return;
    const CornerBounds bounds = corner_bounds_of(points);
    std::size_t axis = 0;
    for (std::size_t k = 1; k < 3; ++k) {
        if (bounds.high[k] - bounds.low[k] > bounds.high[axis] - bounds.low[axis]) axis = k;
    }
    const std::size_t blocks = (points.size() + block_size - 1) / block_size, half = (blocks + 1) / 2 * block_size;
    std::nth_element(points.begin(), points.begin() + std::ptrdiff_t(half), points.end(),
                     [axis](const Point3d& a, const Point3d& b) { return a[axis] < b[axis]; });
    arrange(points.first(half), block_size);
    arrange(points.subspan(half), block_size);
}

}  // namespace

/// A row of a pose, and a bound on the rounding error of its product with a vertex or with a block's bounds.
struct VertexBlocks::Row {
    std::array<double, 4> factors;
    double slack;

    Row(const std::array<double, 4>& row, const Point3d& largest) : factors(row) {
        double magnitude = std::fabs(row[3]);
        for (std::size_t k = 0; k < 3; ++k) magnitude += std::fabs(row[k]) * largest[k];
        // The centre and the half side are sums of at most four products, whose factors are bounded by `magnitude`: at most 16 roundings.
        slack = 16 * std::numeric_limits<double>::epsilon() * magnitude + std::numeric_limits<double>::min();
    }
    double centre(const Block& block) const {
        return factors[0] * block.centre[0] + factors[1] * block.centre[1] + factors[2] * block.centre[2] + factors[3];
    }
    double half(const Block& block) const {
        return std::fabs(factors[0]) * block.half[0] + std::fabs(factors[1]) * block.half[1] +
               std::fabs(factors[2]) * block.half[2] + slack;
    }
};

VertexBlocks::VertexBlocks(std::vector<Point3d> vertices) {
    arrange(vertices, block_size);
    blocks_.reserve((vertices.size() + block_size - 1) / block_size);
    for (std::size_t begin = 0; begin < vertices.size(); begin += block_size) {
        const auto points =
            std::span<const Point3d>(vertices).subspan(begin, std::min(block_size, vertices.size() - begin));
        const CornerBounds bounds = corner_bounds_of(points);
        Block& block = blocks_.emplace_back();
        Places& places = places_.emplace_back();
        for (std::size_t axis = 0; axis < 3; ++axis) {
            block.centre[axis] = bounds.low[axis] / 2 + bounds.high[axis] / 2;
            block.half[axis] = std::max(bounds.high[axis] - block.centre[axis], block.centre[axis] - bounds.low[axis]);
            largest_[axis] = std::max({largest_[axis], std::fabs(bounds.low[axis]), std::fabs(bounds.high[axis])});
            for (std::size_t i = 0; i < block_size; ++i) {
                places[axis][i] = points[std::min(i, points.size() - 1)][axis];
            }
        }
    }
}

void VertexBlocks::extend_by_block(std::size_t block, const Row& row, double& low, double& high) const {
    const std::array<double, 4>& r = row.factors;
    const auto& [x, y, z] = places_[block];
    double least = std::numeric_limits<double>::infinity(), most = -least;
    for (std::size_t i = 0; i < block_size; ++i) {
        const double at = ((r[0] * x[i] + r[1] * y[i]) + r[2] * z[i]) + r[3];
        least = at < least ? at : least;
        most = at > most ? at : most;
    }
    low = std::min(low, least);
    high = std::max(high, most);
}

Box3d VertexBlocks::world_box(const Pose& pose) const {
    Box3d box = {};
    for (std::size_t axis = 0; axis < 3; ++axis) {
        const Row row(pose.rows[axis], largest_);
        std::size_t lowest = 0, highest = 0;
        double reach_low = std::numeric_limits<double>::infinity(), reach_high = -reach_low;
        for (std::size_t i = 0; i < blocks_.size(); ++i) {
            const double centre = row.centre(blocks_[i]), half = row.half(blocks_[i]);
            if (centre - half < reach_low) reach_low = centre - half, lowest = i;
            if (centre + half > reach_high) reach_high = centre + half, highest = i;
        }
        double low = std::numeric_limits<double>::infinity(), high = -low;
        extend_by_block(lowest, row, low, high);
        extend_by_block(highest, row, low, high);
        for (std::size_t i = 0; i < blocks_.size(); ++i) {
            const double centre = row.centre(blocks_[i]), half = row.half(blocks_[i]);
            if (!(centre - half >= low && centre + half <= high)) extend_by_block(i, row, low, high);
        }
        box.min[axis] = low, box.max[axis] = high;
    }
    return box;
}

}  // namespace octopair
