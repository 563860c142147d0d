#include "verification/shapes/enclosure.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <numeric>
#include <tuple>
#include <utility>

namespace octopair::certificate {

namespace {

constexpr std::size_t max_points = 64;

/// Orders points by their coordinates.
struct InOrder {
    static auto key(const Vector& point) { return std::tuple(point.x, point.y, point.z); }
    bool operator()(const Vector& a, const Vector& b) const { return key(a) < key(b); }
    bool operator()(const std::pair<Vector, Vector>& a, const std::pair<Vector, Vector>& b) const {
        return std::pair(key(a.first), key(a.second)) < std::pair(key(b.first), key(b.second));
    }
};

/// Returns whether each edge is in as many triangles of one direction as of the other.
bool is_turned_alike(const std::vector<Triangle>& mesh) {
    std::map<std::pair<Vector, Vector>, int, InOrder> edges;
    for (const Triangle& triangle : mesh) {
        for (std::size_t i = 0; i < 3; ++i) {
            const Vector &from = triangle[i], &to = triangle[(i + 1) % 3];
            InOrder()(from, to) ? ++edges[{from, to}] : --edges[{to, from}];
        }
    }
    return std::ranges::all_of(edges, [](const auto& edge) {
        const auto& [from, to] = edge.first;
        return edge.second == 0 || InOrder::key(from) == InOrder::key(to);
    });
}

/// Returns how often a surface winds around a point, by the solid angles of its triangles.
Real winding_number(const std::vector<Triangle>& mesh, const Vector& point) {
    Real sum = 0;
    for (const Triangle& triangle : mesh) {
        const Vector a = triangle[0] - point, b = triangle[1] - point, c = triangle[2] - point;
        const Real la = length(a), lb = length(b), lc = length(c);
        sum += std::atan2(dot(a, cross(b, c)), la * lb * lc + dot(a, b) * lc + dot(b, c) * la + dot(c, a) * lb);
    }
    return sum / (2 * std::numbers::pi_v<Real>);
}

}  // namespace

std::vector<Vector> points_of_parts(const std::vector<Triangle>& mesh) {
    std::map<Vector, std::size_t, InOrder> numbers;
    std::vector<Vector> corners;
    std::vector<std::size_t> parents;
    const auto number_of = [&](const Vector& corner) {
        const auto [at, is_new] = numbers.emplace(corner, corners.size());
        if (is_new) corners.push_back(corner), parents.push_back(at->second);
        return at->second;
    };
    const auto root_of = [&](std::size_t corner) {
        while (parents[corner] != corner) corner = parents[corner] = parents[parents[corner]];
        return corner;
    };
    for (const Triangle& triangle : mesh) {
        const std::size_t first = root_of(number_of(triangle[0]));
        parents[root_of(number_of(triangle[1]))] = first;
        parents[root_of(number_of(triangle[2]))] = first;
    }
    std::vector<Vector> points;
    for (std::size_t i = 0; i < corners.size(); ++i) {
        if (parents[i] == i) points.push_back(corners[i]);
    }
    return points;
}

Place place_in(const std::vector<Triangle>& mesh, const std::vector<Vector>& points) {
    Place place;
    if (!is_turned_alike(mesh)) return place;
    std::size_t outside = 0;
    for (std::size_t i = 0; i < std::min(points.size(), max_points); ++i) {
        const Real winding = std::abs(winding_number(mesh, points[i]));
        place.any_inside |= std::abs(winding - 1) < 0.01L;
        outside += winding < 0.01L ? 1 : 0;
    }
    place.any_outside = outside > 0;
    place.all_outside = outside == points.size();
    return place;
}

}  // namespace octopair::certificate
