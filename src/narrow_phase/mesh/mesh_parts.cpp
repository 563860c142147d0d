// find_parts(): connected components of a mesh, and which of them are closed.
#include <algorithm>
#include <bit>
#include <cstdint>
#include <numeric>
#include <span>
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

/// Returns a hash of a place. Equal places have equal hashes: 0 and -0 are equal.
std::uint64_t hash_of(const Point3d& place) {
    std::uint64_t hash = 0;
    for (const double at : place)
        hash = (hash ^ std::bit_cast<std::uint64_t>(at + 0.0)) * 0x9E3779B97F4A7C15u ^ hash >> 32;
    return hash;
}

/// Returns for each vertex the first vertex at the same place. Sorts the vertices by hash, and vertices with equal hashes by place.
std::vector<std::uint32_t> merge_places(const std::vector<Point3d>& vertices) {
    const auto bits = unsigned(std::bit_width(vertices.size()));
    const auto bucket_of = [&](const Point3d& vertex) { return std::size_t(hash_of(vertex) >> (64 - bits)); };
    std::vector<std::uint32_t> ends((std::size_t(1) << bits) + 1);
    for (const Point3d& vertex : vertices) ++ends[bucket_of(vertex) + 1];
    std::partial_sum(ends.begin(), ends.end(), ends.begin());
    std::vector<std::uint32_t> order(vertices.size());
    for (std::uint32_t i = 0; i < vertices.size(); ++i) order[ends[bucket_of(vertices[i])]++] = i;

    std::vector<std::uint32_t> first(vertices.size());
    for (std::size_t bucket = 0, begin = 0; bucket + 1 < ends.size(); begin = ends[bucket++]) {
        const std::span same_hash(order.data() + begin, ends[bucket] - begin);
        std::sort(same_hash.begin(), same_hash.end(), [&](std::uint32_t a, std::uint32_t b) {
            return vertices[a] != vertices[b] ? vertices[a] < vertices[b] : a < b;
        });
        for (std::size_t i = 0; i < same_hash.size(); ++i) {
            const bool same = i > 0 && vertices[same_hash[i]] == vertices[same_hash[i - 1]];
            first[same_hash[i]] = same ? first[same_hash[i - 1]] : same_hash[i];
        }
    }
    return first;
}

struct PartState {
    bool closed = true, oriented = true;
};

/// Calls visit(low, high, forward) for each edge of a triangle that does not have both ends at one place. `low` < `high` are places;
/// `forward`: the triangle's boundary runs from low to high.
template <typename Visit>
void for_each_edge(const MeshTree& tree, const std::vector<std::uint32_t>& place, const Visit& visit) {
    for (const auto& corners : tree.triangles) {
        for (int k = 0; k < 3; ++k) {
            const std::uint32_t from = place[corners[k]], to = place[corners[(k + 1) % 3]];
            if (from != to) visit(std::min(from, to), std::max(from, to), from < to);
        }
    }
}

/// Returns the states of the parts, by the numbers of their places. Closed: each edge is in an even number of triangles. Oriented:
/// each edge is as often forward as backward.
std::vector<PartState> judge_edges(const MeshTree& tree, const std::vector<std::uint32_t>& place, DisjointSets& sets) {
    // Edges by their low ends: edge i has its high end and its direction in edges[i].
    std::vector<std::size_t> ends(place.size() + 1);
    for_each_edge(tree, place, [&](std::uint32_t low, std::uint32_t, bool) { ++ends[low + 1]; });
    std::partial_sum(ends.begin(), ends.end(), ends.begin());
    std::vector<std::uint64_t> edges(ends.back());
    for_each_edge(tree, place, [&](std::uint32_t low, std::uint32_t high, bool forward) {
        edges[ends[low]++] = std::uint64_t(high) << 1 | std::uint64_t(forward);
    });
    std::vector<PartState> states(place.size());
    for (std::uint32_t low = 0; low < place.size(); ++low) {
        const std::size_t begin = low == 0 ? 0 : ends[low - 1], end = ends[low];
        if (begin == end) continue;
        std::sort(edges.begin() + std::ptrdiff_t(begin), edges.begin() + std::ptrdiff_t(end));
        PartState& state = states[sets.find(low)];
        for (std::size_t i = begin, next = begin; i < end; i = next) {
            std::size_t forward = 0;
            for (; next < end && edges[next] >> 1 == edges[i] >> 1; ++next) forward += edges[next] & 1;
            state.closed &= (next - i) % 2 == 0;
            state.oriented &= forward * 2 == next - i;
        }
    }
    return states;
}

}  // namespace

MeshParts find_parts(const MeshTree& tree) {
    const std::vector<std::uint32_t> place = merge_places(tree.vertices);
    DisjointSets sets(tree.vertices.size());
    for (const auto& [a, b, c] : tree.triangles) {
        sets.join(place[a], place[b]);
        sets.join(place[a], place[c]);
    }
    const std::vector<PartState> states = judge_edges(tree, place, sets);

    MeshParts parts;
    parts.sides.reserve(tree.triangles.size());
    parts.numbers.reserve(tree.triangles.size());
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
