// Filter "exact triangle": tests triangles that are objects themselves.
//
// All pairs of a batch are tested first. Only the few pairs that remain get findings.
#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <cstdint>
#include <limits>
#include <string>
#include <utility>

#include "base/floating_point_scope.hpp"
#include "boxes/outward_rounding.hpp"
#include "narrow_phase/exact/triangle_contact.hpp"
#include "narrow_phase/exact/triangle_pair.hpp"
#include "narrow_phase/exact/triangle_prefilter.hpp"
#include "octopair/error.hpp"
#include "octopair/filters.hpp"
#include "parallel/team.hpp"
#include "pipeline/per_object.hpp"

namespace octopair {

namespace {

bool is_finite(const Triangle3d& triangle) {
    bool finite = true;
    for (const Point3d& corner : triangle) {
        for (const double at : corner) finite &= std::abs(at) <= std::numeric_limits<double>::max();
    }
    return finite;
}

/// Calls body(begin, size) in parallel for parts of `triangles` triangles.
template <typename Body>
void for_each_part(std::size_t triangles, unsigned threads, const Body& body) {
    constexpr std::size_t part = 1 << 15;
    Team team(triangles <= part ? 1 : threads);
    team.for_each((triangles + part - 1) / part,
                  [&](std::size_t i, unsigned) { body(i * part, std::min(part, triangles - i * part)); });
}

[[noreturn]] void refuse_not_finite(std::span<const Triangle3d> triangles) {
    const auto wrong = std::find_if_not(triangles.begin(), triangles.end(), is_finite);
    const auto index = std::uint64_t(wrong - triangles.begin());
    throw PlacedError(ErrorCode::bad_input, "triangle " + std::to_string(index) + " has a corner that is not finite",
                      {.index = index, .set = 0, .frame = {}});
}

void check(const TriangleSet& set, unsigned threads) {
    std::atomic<bool> all_finite = true;
    for_each_part(set.triangles.size(), threads, [&](std::size_t begin, std::size_t size) {
        const auto part = set.triangles.subspan(begin, size);
        if (!std::all_of(part.begin(), part.end(), is_finite)) all_finite = false;
    });
    if (!all_finite) refuse_not_finite(set.triangles);
    if (!set.owners.empty() && set.owners.size() != set.triangles.size()) {
        throw Error(ErrorCode::bad_input, std::to_string(set.owners.size()) + " owners, but " +
                                              std::to_string(set.triangles.size()) + " triangles");
    }
}

/// Returns whether the distance of the triangles' bounding boxes exceeds `margin` by more than rounding errors.
bool boxes_apart(const Triangle3d& a, const Triangle3d& b, double margin) {
    Point3d gap = {};
    for (std::size_t axis = 0; axis < 3; ++axis) {
        const auto [a_low, a_high] = std::minmax({a[0][axis], a[1][axis], a[2][axis]});
        const auto [b_low, b_high] = std::minmax({b[0][axis], b[1][axis], b[2][axis]});
        gap[axis] = std::max({0.0, a_low - b_high, b_low - a_high});
    }
    constexpr double roundings = 1 + 0x1p-40;
    return std::max({gap[0], gap[1], gap[2]}) > margin * roundings ||
           std::hypot(gap[0], gap[1], gap[2]) > margin * roundings;
}

class TriangleFilter final : public Filter {
public:
    TriangleFilter(const TriangleSet& first, const TriangleOptions& options, const TriangleSet* second)
        : options_(options),
          join_(second != nullptr),
          owners_(first.owners),
          triangles_("triangle", first.triangles, second ? std::optional(second->triangles) : std::nullopt) {}

    std::string_view name() const override { return "exact triangle"; }

    void apply(Batch& batch) const override {
        const auto pairs = batch.pairs();
        check(pairs);
        std::vector<std::uint8_t> prefiltered(pairs.size());
        prefilter_pairs({triangles_.all_first(), triangles_.all_second(), pairs}, prefiltered);
        keep_undecided(batch, prefiltered);
        batch.keep_if([&](std::size_t i) { return counts(batch.pairs()[i], prefiltered[i]); });
        batch.keep_if([&](std::size_t i) {
            describe(batch.pairs()[i], batch.finding(i));
            return true;
        });
    }

private:
    /// Throws: Error{bad_input} that names the first triangle out of range. Checks maxima first, because errors are rare.
    void check(std::span<const Pair> pairs) const {
        std::uint32_t a = 0, b = 0;
        for (const Pair& pair : pairs) {
            a = std::max(a, pair.a);
            b = std::max(b, pair.b);
        }
        if (pairs.empty() || (a < triangles_.all_first().size() && b < triangles_.all_second().size())) return;
        for (const Pair& pair : pairs) triangles_.check(pair);
    }

    /// Returns whether a pair with these flags of the prefilter can be removed without an exact test.
    bool leaves_out(std::uint8_t flags) const {
        if (flags == prefilter_apart) return options_.margin == 0;
        const bool adjacent = !join_ && owners_.empty() && options_.adjacent != AdjacentTriangles::include;
        return flags == (prefilter_apart | prefilter_shared) && adjacent;
    }

    /// Removes the pairs that the prefilter decides. The loop has no branch on the decision. Moves the flags of the remaining pairs to
    /// the front of `prefiltered`.
    void keep_undecided(Batch& batch, std::vector<std::uint8_t>& prefiltered) const {
        const std::array<bool, 4> left_out = {leaves_out(0), leaves_out(1), leaves_out(2), leaves_out(3)};
        std::vector<std::uint32_t> undecided(prefiltered.size());
        std::size_t count = 0;
        for (std::size_t i = 0; i < prefiltered.size(); ++i) {
            const std::uint8_t flags = prefiltered[i];
            undecided[count] = std::uint32_t(i);
            prefiltered[count] = flags;
            count += left_out[flags] ? 0 : 1;
        }
        batch.keep_these(std::span(undecided).first(count));
    }

    bool may_be_adjacent(const Pair& pair) const {
        return !join_ && (owners_.empty() || owners_[pair.a] == owners_[pair.b]);
    }

    bool counts(const Pair& pair, std::uint8_t flags) const {
        const bool apart = (flags & prefilter_apart) != 0, share = (flags & prefilter_shared) != 0;
        if (apart && (share ? may_be_adjacent(pair) : options_.margin == 0)) {
            return share && options_.adjacent == AdjacentTriangles::include;
        }
        const Triangle3d &a = triangles_.first(pair.a), &b = triangles_.second(pair.b);
        if (!share) return (!apart && triangles_meet(a, b)) || within_margin(a, b);
        if (!may_be_adjacent(pair) || options_.adjacent == AdjacentTriangles::include) return true;
        return options_.adjacent == AdjacentTriangles::beyond_shared && meet_beyond_shared(a, b);
    }

    /// Returns whether the distance is at most the margin. Requires: the triangles do not meet.
    bool within_margin(const Triangle3d& a, const Triangle3d& b) const {
        return options_.margin > 0 && !boxes_apart(a, b, options_.margin) &&
               triangle_gap(a, b).distance <= options_.margin;
    }

    void describe(const Pair& pair, Finding& finding) const {
        const Triangle3d &a = triangles_.first(pair.a), &b = triangles_.second(pair.b);
        if (options_.margin > 0 && !triangles_meet(a, b)) {
            const TriangleGap gap = triangle_gap(a, b);
            finding.collision_class = CollisionClass::clearance;
            finding.distance = gap.distance;
            finding.nearest = gap.nearest;
            return;
        }
        finding.collision_class = CollisionClass::collision;
        if (!options_.features) return;
        const TriangleContact common = triangle_contact(a, b);
        finding.contacts = {contact_of(a, b, common)};
        finding.depth = finding.contacts[0].depth;
        finding.depth_kind = DepthKind::least;
        finding.depth_at_most = finding.depth;
        const bool tolerated = options_.tolerance > 0 && finding.depth <= options_.tolerance;
        finding.collision_class = common.meeting == TriangleMeeting::crossing && !tolerated
                                      ? CollisionClass::penetrating
                                      : CollisionClass::touching;
    }

    TriangleOptions options_;
    bool join_;
    std::span<const std::uint32_t> owners_;
    PerObject<Triangle3d> triangles_;
};

}  // namespace

std::unique_ptr<Filter> make_triangle_filter(const TriangleSet& first, const TriangleOptions& options,
                                             const TriangleSet* second) {
    const FloatingPointScope scope;
    check(first, options.threads);
    if (second != nullptr) in_second_set([&] { check(*second, options.threads); });
    if (!(options.margin >= 0 && options.margin <= std::numeric_limits<double>::max())) {
        throw Error(ErrorCode::bad_input, "the margin must be finite and not below 0");
    }
    return std::make_unique<TriangleFilter>(first, options, second);
}

std::vector<Box3f> boxes_of(std::span<const Triangle3d> triangles, unsigned threads) {
    std::vector<Box3f> boxes(triangles.size());
    boxes_of(triangles, boxes, threads);
    return boxes;
}

void boxes_of(std::span<const Triangle3d> triangles, std::span<Box3f> boxes, unsigned threads) {
    const FloatingPointScope scope;
    if (boxes.size() != triangles.size()) {
        throw Error(ErrorCode::bad_input, "boxes_of: the output has " + std::to_string(boxes.size()) + " boxes for " +
                                              std::to_string(triangles.size()) + " triangles");
    }
    std::atomic<bool> all_finite = true;
    for_each_part(triangles.size(), threads, [&](std::size_t begin, std::size_t size) {
        if (!bound_triangles(triangles.subspan(begin, size), boxes.subspan(begin, size))) all_finite = false;
    });
    if (!all_finite) refuse_not_finite(triangles);
}

}  // namespace octopair
