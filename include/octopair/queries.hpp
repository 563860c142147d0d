// Queries of a scene: objects that overlap a box or a sphere, that a ray hits, or that are nearest.
//
// Boxes     Queries use the objects' boxes without margin and padding.
// Exactness Boxes, spheres and distances are decided exactly: each float64 counts as the real number that it is.
// Rules       box      The closed boxes overlap, touching included.
//             sphere   The squared distance between its centre and the box is at most the squared radius.
//             nearest  The Euclidean distance between boxes, 0 if they overlap.
//             ray      Every box that the ray touches is hit. A box that it misses may also be hit if rounding hides the gap
//                      (about 4e-16 relative to the numbers involved). There is no hit where `along` overflows float64.
// Order     Objects are ascending by index; hits by `along`, then index; neighbours by the exact distance, then index.
// Units     Those of the scene.
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "octopair/objects.hpp"

namespace [[gnu::visibility("default")]] octopair {

/// A closed ball. All numbers are finite; radius >= 0.
struct Sphere {
    double centre[3];
    double radius;
};

/// The points origin + along * direction for 0 <= along <= longest. All numbers are finite, but `longest` may be infinite. The
/// direction is not 0. A segment from a to b has the direction b - a and `longest` 1.
struct Ray {
    double origin[3];
    double direction[3];
    double longest = std::numeric_limits<double>::infinity();
};

/// A box that a ray hits.
struct RayHit {
    std::uint32_t index;  ///< index of the object
    double along;         ///< position on the ray where it enters the box; 0 if it begins inside

    bool operator==(const RayHit&) const = default;
};

struct Neighbor {
    std::uint32_t index;  ///< index of the object
    double distance;      ///< exact distance, rounded to the nearest float64; infinite if it overflows

    bool operator==(const Neighbor&) const = default;
};

/// Limits of a search for the nearest objects.
struct NearestLimits {
    std::size_t count;                                        ///< maximum number of objects
    double within = std::numeric_limits<double>::infinity();  ///< maximum Neighbor::distance, at least 0
};

/// Answers to many queries, in the order of the queries. Reuse it for later calls: it keeps its memory.
template <typename Answer>
struct Answers {
    std::vector<Answer> all;        ///< answers of all queries, one query after another
    std::vector<std::size_t> ends;  ///< for each query, the end of its answers in `all`

    /// Returns the number of queries.
    std::size_t size() const { return ends.size(); }
    /// Returns the answers of one query.
    std::span<const Answer> operator[](std::size_t query) const {
        const std::size_t begin = query == 0 ? 0 : ends[query - 1];
        return std::span(all).subspan(begin, ends[query] - begin);
    }
};

}  // namespace octopair
