#include "io/meshes/faces/outline_nodes.hpp"

#include <algorithm>
#include <numeric>

namespace octopair::io {

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
