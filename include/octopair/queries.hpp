// Queries of a scene: what overlaps a box or a sphere, what a ray hits, and what is nearest.
//
// Rules     on the objects' boxes themselves, without margin and paddings. Boxes, spheres and distances are decided exactly:
//           each float64 is taken for the real number that it is, whatever its size.
//             box      the closed boxes overlap, touching included
//             sphere   the squared distance between its centre and the box is at most the squared radius
//             nearest  by the Euclidean distance between boxes, 0 where they overlap
//             ray      no box that it touches is missed; one that it passes may be hit if rounding hides the gap (about
//                      4e-16 of the numbers that it is made of). Where `along` is beyond float64 is no hit.
// Order     ascending index; hits by `along`, then index; neighbours by the exact distance, then index.
// Units     those of the scene.
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "octopair/objects.hpp"

namespace octopair {

/// Centre finite, radius finite and >= 0.
struct Sphere {
    double centre[3];
    double radius;
};

/// The points origin + along * direction for 0 <= along <= longest. Finite, and the direction not 0; `longest` may be
/// infinite. A segment from a to b has the direction b - a and `longest` 1.
struct Ray {
    double origin[3];
    double direction[3];
    double longest = std::numeric_limits<double>::infinity();
};

/// Where a ray enters a box: 0 if it begins inside.
struct RayHit {
    std::uint32_t index;
    double along;

    bool operator==(const RayHit&) const = default;
};

struct Neighbor {
    std::uint32_t index;
    double distance;  ///< the float64 nearest to the exact one; infinite where that is beyond float64

    bool operator==(const Neighbor&) const = default;
};

/// Answers to many queries, in their order. Reuse it from call to call: it keeps its memory.
template <typename Answer>
struct Answers {
    std::vector<Answer> all;
    std::vector<std::size_t> ends;  ///< in `all`, of each query's

    std::size_t size() const { return ends.size(); }
    std::span<const Answer> operator[](std::size_t query) const {
        const std::size_t begin = query == 0 ? 0 : ends[query - 1];
        return std::span(all).subspan(begin, ends[query] - begin);
    }
};

}  // namespace octopair
