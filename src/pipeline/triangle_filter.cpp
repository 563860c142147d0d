// "exact triangle": triangles as objects.
//
// Pairs are judged first and described afterwards: few of those that come in are left, and only these need findings.
#include <algorithm>
#include <bit>
#include <cfloat>
#include <cmath>
#include <cstdint>
#include <limits>
#include <string>
#include <utility>

#include "geometry/exact/pair_look.hpp"
#include "geometry/exact/triangle_contact.hpp"
#include "geometry/exact/triangle_gap.hpp"
#include "geometry/exact/triangle_pair.hpp"
#include "octopair/error.hpp"
#include "octopair/filters.hpp"
#include "pipeline/per_object.hpp"

namespace octopair {

namespace {

/// round_up, without a branch or a call.
float float_above(double value) {
    const float nearest = float(std::clamp(value, -double(FLT_MAX), double(FLT_MAX))) + 0.0f;
    // The next float is the next integer, or the one before where floats are below 0.
    const auto bits = std::bit_cast<std::uint32_t>(nearest);
    const std::uint32_t step = nearest < 0 ? ~std::uint32_t(0) : 1;
    return std::bit_cast<float>(bits + (double(nearest) < value && nearest < FLT_MAX ? step : 0)) + 0.0f;
}

bool is_finite(const Triangle3d& triangle) {
    bool finite = true;
    for (const Point3d& corner : triangle) {
        for (const double at : corner) finite &= std::abs(at) <= std::numeric_limits<double>::max();
    }
    return finite;
}

void check_finite(std::span<const Triangle3d> triangles) {
    const auto wrong = std::find_if_not(triangles.begin(), triangles.end(), is_finite);
    if (wrong == triangles.end()) return;
    throw Error(ErrorCode::bad_input,
                "triangle " + std::to_string(wrong - triangles.begin()) + " has a corner that is not finite");
}

void check(const TriangleSet& set) {
    check_finite(set.triangles);
    if (!set.owners.empty() && set.owners.size() != set.triangles.size()) {
        throw Error(ErrorCode::bad_input, std::to_string(set.owners.size()) + " owners, but " +
                                              std::to_string(set.triangles.size()) + " triangles");
    }
}

/// True if their boxes say that they are further apart than this, whatever roundings make of it.
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

/// In the middle of what two triangles that meet have in common.
Contact contact_of(const Triangle3d& a, const Triangle3d& b, const TriangleContact& common) {
    Contact contact = {};
    for (unsigned i = 0; i < common.count; ++i) {
        for (std::size_t axis = 0; axis < 3; ++axis) contact.point[axis] += common.points[i][axis] / common.count;
    }
    const TriangleDepth way_out = triangle_depth(a, b);
    contact.normal = way_out.normal;
    contact.depth = way_out.depth;
    return contact;
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
        for (const Pair& pair : pairs) triangles_.check(pair);
        std::vector<std::uint8_t> looks(pairs.size());
        look_at({triangles_.all_first(), triangles_.all_second(), pairs}, looks);
        batch.keep_if([&](std::size_t i) { return counts(batch.pairs()[i], looks[i]); });
        batch.keep_if([&](std::size_t i) {
            describe(batch.pairs()[i], batch.finding(i));
            return true;
        });
    }

private:
    bool may_be_adjacent(const Pair& pair) const {
        return !join_ && (owners_.empty() || owners_[pair.a] == owners_[pair.b]);
    }

    bool counts(const Pair& pair, std::uint8_t look) const {
        const bool apart = (look & look_apart) != 0, share = (look & look_shared) != 0;
        if (apart && (share ? may_be_adjacent(pair) : options_.margin == 0)) {
            return share && options_.adjacent == AdjacentTriangles::include;
        }
        const Triangle3d &a = triangles_.first(pair.a), &b = triangles_.second(pair.b);
        if (!share) return (!apart && triangles_meet(a, b)) || within_margin(a, b);
        if (!may_be_adjacent(pair) || options_.adjacent == AdjacentTriangles::include) return true;
        return options_.adjacent == AdjacentTriangles::beyond_shared && meet_beyond_shared(a, b);
    }

    /// Of triangles that do not meet.
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
        finding.collision_class =
            common.meeting == TriangleMeeting::crossing ? CollisionClass::penetrating : CollisionClass::touching;
        finding.contacts = {contact_of(a, b, common)};
        finding.depth = finding.contacts[0].depth;
    }

    TriangleOptions options_;
    bool join_;
    std::span<const std::uint32_t> owners_;
    PerObject<Triangle3d> triangles_;
};

}  // namespace

std::unique_ptr<Filter> make_triangle_filter(const TriangleSet& first, const TriangleOptions& options,
                                             const TriangleSet* second) {
    check(first);
    if (second != nullptr) check(*second);
    if (!(options.margin >= 0 && options.margin <= std::numeric_limits<double>::max())) {
        throw Error(ErrorCode::bad_input, "the margin must be finite and not below 0");
    }
    return std::make_unique<TriangleFilter>(first, options, second);
}

std::vector<Box3f> boxes_of(std::span<const Triangle3d> triangles) {
    std::vector<Box3f> boxes(triangles.size());
    bool all_finite = true;
    for (std::size_t i = 0; i < boxes.size(); ++i) {
        const auto& [a, b, c] = triangles[i];
        all_finite &= is_finite(triangles[i]);
        for (std::size_t axis = 0; axis < 3; ++axis) {
            boxes[i].min[axis] = 0.0f - float_above(-std::min(std::min(a[axis], b[axis]), c[axis]));
            boxes[i].max[axis] = float_above(std::max(std::max(a[axis], b[axis]), c[axis]));
        }
    }
    if (!all_finite) check_finite(triangles);
    return boxes;
}

}  // namespace octopair
