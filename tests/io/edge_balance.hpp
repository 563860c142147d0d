// EdgeBalance: how often directed edges occur, forward less backward. A mesh is closed and oriented if the balance of each edge is 0.
#pragma once

#include <algorithm>
#include <cstdint>
#include <map>
#include <span>
#include <utility>

#include "octopair/pose.hpp"

namespace octopair::test {

/// Edges between places: corners at one place are alike.
class EdgeBalance {
public:
    /// Adds the edges of a closed way through the places of `corners`, `times` times.
    template <typename PlaceOf>
    void add(std::span<const std::uint32_t> corners, const PlaceOf& place_of, int times) {
        for (std::size_t i = 0; i < corners.size(); ++i) {
            const Point3d from = place_of(corners[i]), to = place_of(corners[(i + 1) % corners.size()]);
            if (from == to) continue;
            edges_[{std::min(from, to), std::max(from, to)}] += from < to ? times : -times;
        }
    }

    bool is_zero() const {
        return std::all_of(edges_.begin(), edges_.end(), [](const auto& edge) { return edge.second == 0; });
    }

private:
    std::map<std::pair<Point3d, Point3d>, int> edges_;
};

}  // namespace octopair::test
