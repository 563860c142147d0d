#include "io/meshes/faces/plane_outline.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <numeric>
#include <vector>

#include "geometry/vector.hpp"
#include "io/files/failure.hpp"

namespace octopair::io {

namespace {

/// A sum of float64 numbers with the sum of its rounding errors. Source: Neumaier, 1974.
class CompensatedSum {
public:
    void add(double term) {
        const double sum = sum_ + term;
        lost_ += std::abs(sum_) >= std::abs(term) ? (sum_ - sum) + term : (term - sum) + sum_;
        sum_ = sum;
    }
    double value() const { return sum_ + lost_; }

private:
    double sum_ = 0, lost_ = 0;
};

unsigned longest_axis(const Point3d& vector) {
    unsigned axis = 0;
    for (unsigned k = 1; k < 3; ++k) {
        if (std::abs(vector[k]) > std::abs(vector[axis])) axis = k;
    }
    return axis;
}

/// Twice the area vector of an outline.
struct AreaVector {
    Point3d sum = {};
    Point3d sizes = {};  ///< sum of the absolute values of all terms

    /// Returns whether rounding errors and underflow are far smaller than the vector. False if a number is infinite or undefined.
    bool is_certain() const {
        const double largest = std::abs(sum[longest_axis(sum)]), size = sizes[0] + sizes[1] + sizes[2];
        return largest > 0x1p-40 * size && largest > 0x1p-900 && size < 0x1p1000;
    }
};

/// Returns the area vector of an outline with this number of corners. `way(i)` returns the vector from the first corner to corner i.
template <typename Way>
AreaVector area_vector(std::size_t corners, const Way& way) {
    std::array<CompensatedSum, 3> sums;
    AreaVector area;
    Point3d before = way(1);
    for (std::size_t i = 2; i < corners; ++i) {
        const Point3d at = way(i);
        const Point3d term = vector::cross(before, at);
        for (std::size_t k = 0; k < 3; ++k) {
            sums[k].add(term[k]);
            area.sizes[k] += std::abs(term[k]);
        }
        before = at;
    }
    area.sum = {sums[0].value(), sums[1].value(), sums[2].value()};
    return area;
}

/// Returns the sum of the absolute values of the turns at the corners, along each axis. For an outline in a plane, the vector is parallel
/// to the normal, except for the signs. The vector is 0 if all corners are in line.
template <typename Way>
Point3d turn_sizes(std::size_t corners, const Way& way) {
    Point3d sizes = {}, at = way(0), edge = {};
    for (std::size_t i = 1; i < corners; ++i) {
        const Point3d next = way(i);
        if (next == at) continue;
        const Point3d turn = vector::cross(edge, vector::minus(next, at));
        for (std::size_t k = 0; k < 3; ++k) sizes[k] += std::abs(turn[k]);
        edge = vector::minus(next, at);
        at = next;
    }
    return sizes;
}

/// Returns the vectors from the first corner to each corner, scaled so that the longest is about 1.
std::vector<Point3d> scaled_ways(std::span<const Point3d> places) {
    std::vector<Point3d> ways;
    double largest = 0;
    for (const Point3d& place : places) {
        ways.push_back(vector::minus(vector::times(place, 0.5), vector::times(places[0], 0.5)));
        for (const double at : ways.back()) largest = std::max(largest, std::abs(at));
    }
    const int exponent = largest > 0 ? std::ilogb(largest) : 0;
    for (Point3d& way : ways) {
        for (double& at : way) at = std::ldexp(at, -exponent);
    }
    return ways;
}

}  // namespace

void StopCheck::check() const {
    if (stop_.stop_requested()) cancel();
}

PlaneOutline::PlaneOutline(std::span<const Point3d> places, StopCheck& check) : places_(places), check_(check) {
    AreaVector area = area_vector(places.size(), [&](std::size_t i) { return vector::minus(places[i], places[0]); });
    axis_ = longest_axis(area.sum);
    if (!area.is_certain()) {
        const std::vector<Point3d> ways = scaled_ways(places);
        const auto way = [&](std::size_t i) { return ways[i]; };
        area = area_vector(places.size(), way);
        axis_ = longest_axis(area.is_certain() ? area.sum : turn_sizes(places.size(), way));
    }
    u_ = axis_ == 2 ? 0 : axis_ + 1;
    v_ = axis_ == 0 ? 2 : axis_ - 1;
    counterclockwise_ = !(area.sum[axis_] < 0);
}

bool PlaneOutline::is_convex() const {
    std::uint32_t before = size() - 1, at = 0;
    while (before > 0 && compare(before, at) == 0) --before;
    if (before == 0) return true;
    // All turns have one direction, and the outline changes between rightward and leftward twice. So it goes round once.
    const int wrong = counterclockwise_ ? -1 : 1;
    unsigned changes = 0;
    int way = compare(before, at);
    for (std::uint32_t i = 1; i <= size(); ++i) {
        const std::uint32_t next = i == size() ? 0 : i;
        const int next_way = compare(at, next);
        if (next_way == 0) continue;
        if (side(before, at, next) == wrong) return false;
        changes += unsigned(next_way != way);
        way = next_way;
        before = at;
        at = next;
    }
    return changes <= 2;
}

OutlineNodes::OutlineNodes(const PlaneOutline& outline) : nodes_(outline.size()) {
    std::vector<std::uint32_t> order(outline.size());
    std::iota(order.begin(), order.end(), 0u);
    std::sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) {
        const int ways = outline.compare(a, b);
        return ways != 0 ? ways < 0 : a < b;
    });
    for (const std::uint32_t corner : order) {
        if (corners_.empty() || outline.compare(corners_.back(), corner) != 0) {
            corners_.push_back(corner);
            places_.push_back(outline.place(corner));
        }
        nodes_[corner] = size() - 1;
    }
    for (std::uint32_t i = 0; i < outline.size(); ++i) {
        const std::uint32_t from = nodes_[i], to = nodes_[i + 1 < outline.size() ? i + 1 : 0];
        if (from != to) edges_.push_back({std::min(from, to), std::max(from, to), from < to ? 1 : -1});
    }
    starting_ = by_node(&OutlineEdge::low);
    ending_ = by_node(&OutlineEdge::high);
}

OutlineNodes::EdgesByNode OutlineNodes::by_node(std::uint32_t OutlineEdge::*end) const {
    EdgesByNode sorted;
    sorted.begins.resize(corners_.size() + 1);
    for (const OutlineEdge& edge : edges_) ++sorted.begins[edge.*end + 1];
    std::partial_sum(sorted.begins.begin(), sorted.begins.end(), sorted.begins.begin());
    std::vector<std::uint32_t> next(sorted.begins);
    sorted.numbers.resize(edges_.size());
    for (std::uint32_t i = 0; i < edges_.size(); ++i) sorted.numbers[next[edges_[i].*end]++] = i;
    return sorted;
}

}  // namespace octopair::io
