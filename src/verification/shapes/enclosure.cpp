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

bool is_closed(const std::vector<Triangle>& mesh) {
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

std::vector<std::size_t> parts_of(const std::vector<Triangle>& mesh) {
    std::map<Vector, std::size_t, InOrder> numbers;
    std::vector<std::size_t> triangles, parents;  // by corner: a triangle that has it; a corner of its part, or itself
    std::size_t triangle = 0;
    const auto number_of = [&](const Vector& corner) {
        const auto [at, is_new] = numbers.emplace(corner, parents.size());
        if (is_new) triangles.push_back(triangle), parents.push_back(at->second);
        return at->second;
    };
    const auto root_of = [&](std::size_t corner) {
        while (parents[corner] != corner) corner = parents[corner] = parents[parents[corner]];
        return corner;
    };
    for (; triangle < mesh.size(); ++triangle) {
        const std::size_t first = root_of(number_of(mesh[triangle][0]));
        parents[root_of(number_of(mesh[triangle][1]))] = first;
        parents[root_of(number_of(mesh[triangle][2]))] = first;
    }
    std::vector<std::size_t> parts;
    for (std::size_t corner = 0; corner < parents.size(); ++corner) {
        if (parents[corner] == corner) parts.push_back(triangles[corner]);
    }
    return parts;
}

Enclosure enclosure_in(const std::vector<Triangle>& mesh, const std::vector<Vector>& points) {
    Enclosure enclosure{.is_known = points.size() <= max_points};
    std::size_t outside = 0;
    for (std::size_t i = 0; i < std::min(points.size(), max_points); ++i) {
        const Real winding = std::abs(winding_number(mesh, points[i]));
        enclosure.any_inside |= std::abs(winding - 1) < 0.01L;
        outside += winding < 0.01L ? 1 : 0;
    }
    enclosure.any_outside = outside > 0;
    enclosure.all_outside = outside == points.size();
    return enclosure;
}

}  // namespace octopair::certificate
