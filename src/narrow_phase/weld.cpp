// weld(): joins vertices that are near each other, with a hash grid whose cells are as long as the tolerance.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numeric>
#include <unordered_map>
#include <utility>
#include <vector>

#include "geometry/vector.hpp"
#include "octopair/error.hpp"
#include "octopair/shapes.hpp"

namespace octopair {

namespace {

using Cell = std::array<std::int64_t, 3>;

struct CellHash {
    std::size_t operator()(const Cell& cell) const {
        std::uint64_t hash = 0;
        for (const std::int64_t at : cell) hash = (hash ^ std::uint64_t(at)) * 0x9E3779B97F4A7C15U;
        return std::size_t(hash ^ hash >> 32);
    }
};

class Welding {
public:
    /// `loose`: the vertices to join, in ascending order.
    Welding(const std::vector<Point3d>& vertices, const std::vector<std::uint32_t>& loose, double tolerance)
        : vertices_(vertices), tolerance_(tolerance), firsts_(vertices.size()) {
        std::iota(firsts_.begin(), firsts_.end(), 0U);
        for (const std::uint32_t vertex : loose) join_with_earlier(vertex);
    }

    /// Returns the vertex that stands for all vertices joined with `vertex`: the end of the chain in firsts_.
    std::uint32_t first(std::uint32_t vertex) {
        while (firsts_[vertex] != vertex) vertex = firsts_[vertex] = firsts_[firsts_[vertex]];
        return vertex;
    }

private:
    /// Returns the grid cell of a place. Coordinates beyond the range of integers get the same cell, which only takes more time.
    Cell cell_of(const Point3d& place) const {
        constexpr double most = 0x1p62;
        Cell cell;
        for (std::size_t axis = 0; axis < 3; ++axis) {
            cell[axis] = std::int64_t(std::clamp(std::floor(place[axis] / tolerance_), -most, most));
        }
        return cell;
    }

    void join_with_earlier(std::uint32_t vertex) {
        const Cell cell = cell_of(vertices_[vertex]);
        for (unsigned i = 0; i < 27; ++i) {
            const Cell next = {cell[0] + int(i % 3) - 1, cell[1] + int(i / 3 % 3) - 1, cell[2] + int(i / 9) - 1};
            const auto found = cells_.find(next);
            if (found == cells_.end()) continue;
            for (const std::uint32_t other : found->second) {
                if (vector::length(vector::minus(vertices_[vertex], vertices_[other])) > tolerance_) continue;
                const std::uint32_t a = first(vertex), b = first(other);
                firsts_[std::max(a, b)] = std::min(a, b);
            }
        }
        cells_[cell].push_back(vertex);
    }

    const std::vector<Point3d>& vertices_;
    double tolerance_;
    std::vector<std::uint32_t> firsts_;  // by vertex: an earlier vertex that it was joined with, or itself
    std::unordered_map<Cell, std::vector<std::uint32_t>, CellHash> cells_;
};

/// Joins vertices that have equal coordinates.
void join_equal(shape::Mesh& mesh) {
    std::vector<std::uint32_t> order(mesh.vertices.size()), firsts(mesh.vertices.size());
    std::iota(order.begin(), order.end(), 0U);
    const auto& places = mesh.vertices;
    std::sort(order.begin(), order.end(),
              [&](std::uint32_t a, std::uint32_t b) { return places[a] != places[b] ? places[a] < places[b] : a < b; });
    for (std::size_t i = 0; i < order.size(); ++i) {
        const bool equal = i > 0 && places[order[i]] == places[order[i - 1]];
        firsts[order[i]] = equal ? firsts[order[i - 1]] : order[i];
    }
    for (auto& triangle : mesh.triangles) {
        for (std::uint32_t& corner : triangle) corner = firsts[corner];
    }
}

/// Returns the vertices at the edges of gaps, in ascending order: ends of edges that are in an odd number of triangles.
std::vector<std::uint32_t> loose_vertices(const shape::Mesh& mesh) {
    using Edge = std::pair<std::uint32_t, std::uint32_t>;
    std::vector<Edge> edges;
    edges.reserve(mesh.triangles.size() * 3);
    for (const auto& triangle : mesh.triangles) {
        for (std::size_t i = 0; i < 3; ++i) {
            const auto [low, high] = std::minmax(triangle[i], triangle[(i + 1) % 3]);
            if (low != high) edges.emplace_back(low, high);
        }
    }
    std::sort(edges.begin(), edges.end());
    std::vector<std::uint32_t> loose;
    for (std::size_t begin = 0, end = 0; begin < edges.size(); begin = end) {
        while (end < edges.size() && edges[end] == edges[begin]) ++end;
        if ((end - begin) % 2 == 0) continue;
        loose.push_back(edges[begin].first);
        loose.push_back(edges[begin].second);
    }
    std::sort(loose.begin(), loose.end());
    loose.erase(std::unique(loose.begin(), loose.end()), loose.end());
    return loose;
}

}  // namespace

void weld(shape::Mesh& mesh, double tolerance) {
    if (!std::isfinite(tolerance) || tolerance < 0) {
        throw Error(ErrorCode::bad_input, "the tolerance of a weld must be finite and >= 0");
    }
    join_equal(mesh);
    if (tolerance == 0) return;
    Welding welding(mesh.vertices, loose_vertices(mesh), tolerance);
    for (auto& triangle : mesh.triangles) {
        for (std::uint32_t& corner : triangle) corner = welding.first(corner);
    }
}

}  // namespace octopair
