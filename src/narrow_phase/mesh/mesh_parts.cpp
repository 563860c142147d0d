// find_parts(): connected components of a mesh, and which of them are closed.
#include <algorithm>
#include <cstdint>
#include <numeric>
#include <vector>

#include "narrow_phase/mesh/mesh_tree.hpp"

namespace octopair {

namespace {

/// Union-find over numbers. The representative of a set is its smallest number.
class DisjointSets {
public:
    explicit DisjointSets(std::size_t count) : parents_(count) { std::iota(parents_.begin(), parents_.end(), 0u); }

    std::uint32_t find(std::uint32_t number) {
        while (parents_[number] != number) {
            parents_[number] = parents_[parents_[number]];
            number = parents_[number];
        }
        return number;
    }
    void join(std::uint32_t a, std::uint32_t b) {
        a = find(a);
        b = find(b);
        parents_[std::max(a, b)] = std::min(a, b);
    }

private:
    std::vector<std::uint32_t> parents_;
};

/// Returns for each vertex the first vertex at the same place.
std::vector<std::uint32_t> merge_places(const std::vector<Point3d>& vertices) {
    std::vector<std::uint32_t> order(vertices.size());
    std::iota(order.begin(), order.end(), 0u);
    std::sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) {
        return vertices[a] != vertices[b] ? vertices[a] < vertices[b] : a < b;
    });
    std::vector<std::uint32_t> first(vertices.size());
    for (std::size_t i = 0; i < order.size(); ++i) {
        const bool same = i > 0 && vertices[order[i]] == vertices[order[i - 1]];
        first[order[i]] = same ? first[order[i - 1]] : order[i];
    }
    return first;
}

/// An edge of a triangle.
struct SharedEdge {
    std::uint32_t low, high;  ///< vertices, low < high
    std::uint32_t part;
    bool forward;  ///< the triangle's boundary runs from low to high
};

struct PartState {
    bool closed = true, oriented = true;
};

/// Sets the states of the parts. Closed: each edge is in an even number of triangles. Oriented: each edge is as often forward
/// as backward.
void judge_edges(std::vector<SharedEdge>& edges, std::vector<PartState>& states) {
    std::sort(edges.begin(), edges.end(), [](const SharedEdge& a, const SharedEdge& b) {
        return a.low != b.low ? a.low < b.low : a.high < b.high;
    });
    for (std::size_t begin = 0, end = 0; begin < edges.size(); begin = end) {
        std::size_t forward = 0;
        while (end < edges.size() && edges[end].low == edges[begin].low && edges[end].high == edges[begin].high) {
            forward += edges[end].forward;
            ++end;
        }
        PartState& state = states[edges[begin].part];
        state.closed &= (end - begin) % 2 == 0;
        state.oriented &= forward * 2 == end - begin;
    }
}

}  // namespace

MeshParts find_parts(const MeshTree& tree) {
    const std::vector<std::uint32_t> place = merge_places(tree.vertices);
    DisjointSets sets(tree.vertices.size());
    for (const auto& [a, b, c] : tree.triangles) {
        sets.join(place[a], place[b]);
        sets.join(place[a], place[c]);
    }
    std::vector<SharedEdge> edges;
    edges.reserve(tree.triangles.size() * 3);
    for (const auto& corners : tree.triangles) {
        for (int k = 0; k < 3; ++k) {
            const std::uint32_t from = place[corners[k]], to = place[corners[(k + 1) % 3]];
            if (from != to) edges.push_back({std::min(from, to), std::max(from, to), sets.find(from), from < to});
        }
    }
    std::vector<PartState> states(tree.vertices.size());
    judge_edges(edges, states);

    MeshParts parts;
    constexpr std::uint32_t none = ~std::uint32_t(0);
    std::vector<std::uint32_t> numbers(tree.vertices.size(), none);
    for (const auto& corners : tree.triangles) {
        const std::uint32_t part = sets.find(place[corners[0]]);
        const PartState& state = states[part];
        using Side = MeshParts::Side;
        parts.sides.push_back(!state.closed ? Side::open : state.oriented ? Side::oriented : Side::unoriented);
        parts.any_closed |= state.closed;
        if (numbers[part] == none) {
            numbers[part] = std::uint32_t(parts.corners.size());
            parts.corners.push_back(tree.vertices[corners[0]]);
        }
        parts.numbers.push_back(numbers[part]);
    }
    return parts;
}

}  // namespace octopair
