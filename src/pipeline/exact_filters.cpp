// Filters "exact object" and "exact feature": the exact stages for objects.
#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "base/floating_point_scope.hpp"
#include "geometry/vector.hpp"
#include "narrow_phase/mesh/mesh_tree.hpp"
#include "narrow_phase/motion/time_of_impact.hpp"
#include "narrow_phase/object_pair.hpp"
#include "narrow_phase/prepared.hpp"
#include "octopair/error.hpp"
#include "octopair/filters.hpp"
#include "pipeline/per_object.hpp"

namespace octopair {

namespace {

/// The posed objects of pairs, from one set or from two.
class PosedPairs {
public:
    PosedPairs(const ShapedObjects& first, const ShapedObjects* second)
        : first_(first),
          second_(second ? *second : first),
          moving_(!first_.end_poses.empty() || !second_.end_poses.empty()) {
        check(first_);
        in_second_set([this] { check(second_); });
        first_open_ = open_geometries(first_);
        second_open_ = open_geometries(second_);
    }

    /// Returns whether any object moves.
    bool moving() const { return moving_; }
    PosedObject a(const Pair& pair) const { return {prepared(first_, pair.a), first_.poses[pair.a]}; }
    PosedObject b(const Pair& pair) const { return {prepared(second_, pair.b), second_.poses[pair.b]}; }
    MovingObject moving_a(const Pair& pair) const { return moving(first_, pair.a); }
    MovingObject moving_b(const Pair& pair) const { return moving(second_, pair.b); }
    std::array<bool, 2> open(const Pair& pair) const {
        return {first_open_[first_.geometry[pair.a]], second_open_[second_.geometry[pair.b]]};
    }
    double padding(const Pair& pair) const { return padding_of(first_, pair.a) + padding_of(second_, pair.b); }

private:
    static const detail::PreparedShape& prepared(const ShapedObjects& objects, std::uint32_t i) {
        return detail::prepared(objects.geometries[objects.geometry[i]]);
    }
    static MovingObject moving(const ShapedObjects& objects, std::uint32_t i) {
        const Pose& begin = objects.poses[i];
        return {prepared(objects, i),
                *Motion::between(begin, objects.end_poses.empty() ? begin : objects.end_poses[i])};
    }
    static std::vector<bool> open_geometries(const ShapedObjects& objects) {
        std::vector<bool> open(objects.geometries.size());
        for (std::size_t i = 0; i < open.size(); ++i) open[i] = !objects.geometries[i].closed();
        return open;
    }
    static double padding_of(const ShapedObjects& objects, std::uint32_t i) {
        return objects.padding.empty() ? 0 : objects.padding[i];
    }

    ShapedObjects first_, second_;
    bool moving_;
    std::vector<bool> first_open_, second_open_;  // by geometry; true: an open mesh
};

/// The poses of two moving objects at one time.
struct Moment {
    Moment(const MovingObject& first, const MovingObject& second, double at)
        : time(at),
          pose_a(first.motion.at(at)),
          pose_b(second.motion.at(at)),
          geometry_a(first.geometry),
          geometry_b(second.geometry) {}

    PosedObject a() const { return {geometry_a, pose_a}; }
    PosedObject b() const { return {geometry_b, pose_b}; }

    double time;
    Pose pose_a, pose_b;
    const detail::PreparedShape &geometry_a, &geometry_b;
};

struct MovingPair {
    MovingObject a, b;
};

/// Returns whether two moving objects meet, or come within `reach`. Sets `finding` to describe the first such moment. At this moment
/// a gap as large as the tolerance of first_time_within() may be left, unless the objects meet at the beginning.
bool judge_moving(const MovingPair& pair, double reach, Finding& finding, const std::stop_token& stop) {
    const auto& [a, b] = pair;
    constexpr double infinity = std::numeric_limits<double>::infinity();
    const auto meeting = first_time_within(a, b, 0, stop);
    const auto time = meeting || !(reach > 0) ? meeting : first_time_within(a, b, reach, stop);
    if (!time) return false;
    const Moment moment(a, b, *time);
    judge_objects(moment.a(), moment.b(), infinity, finding);
    if (meeting && finding.collision_class == CollisionClass::clearance) {
        finding.collision_class = CollisionClass::collision;
        finding.distance = 0;
    }
    // The distance may exceed `reach` by the tolerance of first_time_within().
    if (finding.collision_class == CollisionClass::clearance) finding.distance = std::min(finding.distance, reach);
    finding.time = *time;
    return true;
}

/// Finds the contacts at the time of impact. If a gap is left, the middle of its nearest points is the contact.
void find_impact(const Moment& moment, const ContactRequest& request, Finding& finding) {
    Finding at_moment;
    judge_objects(moment.a(), moment.b(), std::numeric_limits<double>::infinity(), at_moment);
    if (at_moment.collision_class != CollisionClass::clearance) {
        find_contacts(moment.a(), moment.b(), request, finding);
        return;
    }
    finding.collision_class = CollisionClass::touching;
    finding.depth_kind = DepthKind::least;
    finding.more_contacts = request.max_contacts == 0;
    if (request.max_contacts == 0) return;
    const auto& [on_a, on_b] = at_moment.nearest;
    Contact contact;
    for (int axis = 0; axis < 3; ++axis) {
        contact.point[axis] = on_a[axis] / 2 + on_b[axis] / 2;
        contact.normal[axis] = (on_b[axis] - on_a[axis]) / at_moment.distance;
    }
    finding.contacts = {contact};
}

/// Returns whether a point of the world is in the interior of an object's bounding box, which is turned with the object.
bool is_in_bounds(const Point3d& point, const PosedObject& object) {
    const ShapeBounds& bounds = object.geometry.bounds;
    if (!bounds.bounded) return false;
    const Point3d offset = vector::minus(point, vector::posed(object.pose, bounds.centre));
    for (std::size_t k = 0; k < 3; ++k) {
        // Cramer's rule: the coordinate along axis k is the first product, divided by the second.
        const auto axis = [&](std::size_t i) { return vector::column(object.pose, i % 3); };
        const Point3d normal = vector::cross(axis(k + 1), axis(k + 2));
        const double half = bounds.box.max[k] - bounds.centre[k];
        constexpr double inner = 1 - 1e-9;  // keeps corners that lie on the box outside, despite rounding
        if (!(std::fabs(vector::dot(offset, normal)) < inner * half * std::fabs(vector::dot(axis(k), normal))))
            return false;
    }
    return true;
}

/// Returns a point of an object: a corner of a mesh, or the middle of another shape. Requires: the shape is bounded.
Point3d point_of(const PosedObject& object) {
    const MeshTree& tree = *object.geometry.tree;
    const bool is_mesh = !tree.triangles.empty();
    return vector::posed(object.pose, is_mesh ? tree.vertices[tree.triangles[0][0]] : object.geometry.bounds.centre);
}

/// Returns whether `inner` may be inside `open`, a mesh that is not closed. Tests one point of `inner` against the box of `open`.
bool may_be_inside(const PosedObject& inner, const PosedObject& open) {
    return inner.geometry.bounds.bounded && is_in_bounds(point_of(inner), open);
}

/// Returns whether the objects of pair `i` meet or come within the margin. If so, replaces the pair's finding, but keeps its note.
bool judge(const PosedPairs& objects, const ExactOptions& options, Batch& batch, std::size_t i) {
    const Pair pair = batch.pairs()[i];
    const double reach = options.margin + objects.padding(pair);
    Finding found;
    const bool counts = objects.moving()
                            ? judge_moving({objects.moving_a(pair), objects.moving_b(pair)}, reach, found, batch.stop())
                            : judge_objects(objects.a(pair), objects.b(pair), reach, found);
    const auto [a_open, b_open] = objects.open(pair);
    if (!counts) {
        const PosedObject a = objects.a(pair), b = objects.b(pair);
        if (!(a_open && may_be_inside(b, a)) && !(b_open && may_be_inside(a, b))) return false;
        batch.count_undecided();
        if (!options.keep_undecided || objects.moving()) return false;
        found = {.collision_class = CollisionClass::undecided};
    }
    Finding& finding = batch.finding(i);
    found.note = finding.note;
    found.open = {a_open, b_open};
    finding = std::move(found);
    return true;
}

class ExactObjectFilter final : public Filter {
public:
    ExactObjectFilter(const PosedPairs& objects, const ExactOptions& options) : objects_(objects), options_(options) {}

    std::string_view name() const override { return "exact object"; }

    void apply(Batch& batch) const override {
        batch.keep_if([&](std::size_t i) { return judge(objects_, options_, batch, i); });
    }

private:
    PosedPairs objects_;
    ExactOptions options_;
};

class ExactFeatureFilter final : public Filter {
public:
    ExactFeatureFilter(const PosedPairs& objects, const ExactOptions& options) : objects_(objects), options_(options) {}

    std::string_view name() const override { return "exact feature"; }

    void apply(Batch& batch) const override {
        const ContactRequest request{options_.max_contacts, batch.stop(), options_.tolerance,
                                     options_.duplicate_tolerance.value_or(options_.tolerance)};
        batch.keep_if([&](std::size_t i) {
            const Pair pair = batch.pairs()[i];
            // If no "exact object" filter ran before, this filter also decides whether the objects meet.
            const bool judged = batch.finding(i).collision_class != CollisionClass::unknown;
            if (!judged && !judge(objects_, options_, batch, i)) return false;
            Finding& finding = batch.finding(i);
            if (finding.collision_class == CollisionClass::clearance ||
                finding.collision_class == CollisionClass::undecided) {
                return true;
            }
            if (objects_.moving()) {
                find_impact({objects_.moving_a(pair), objects_.moving_b(pair), finding.time}, request, finding);
            } else {
                find_contacts(objects_.a(pair), objects_.b(pair), request, finding);
            }
            if (finding.thickness_kind == ThicknessKind::undecided) batch.count_undecided();
            return true;
        });
    }

private:
    PosedPairs objects_;
    ExactOptions options_;
};

void check_length(double length, const std::string& what) {
    if (std::isfinite(length) && length >= 0) return;
    throw Error(ErrorCode::bad_input, what + " must be finite and >= 0");
}

void check(const ExactOptions& options) {
    check_length(options.margin, "the margin");
    check_length(options.tolerance, "the tolerance");
    check_length(options.duplicate_tolerance.value_or(0), "the tolerance of duplicates");
}

class DepthFilter final : public Filter {
public:
    explicit DepthFilter(double min_depth) : min_depth_(min_depth) {}

    std::string_view name() const override { return "depth"; }

    void apply(Batch& batch) const override {
        batch.keep_if([&](std::size_t i) {
            const Finding& finding = batch.finding(i);
            const bool thin = finding.collision_class == CollisionClass::touching &&
                              finding.thickness_kind == ThicknessKind::at_most && finding.thickness < min_depth_;
            return finding.depth_kind == DepthKind::unknown || (finding.depth_at_most >= min_depth_ && !thin);
        });
    }

private:
    double min_depth_;
};

}  // namespace

std::unique_ptr<Filter> make_depth_filter(double min_depth) {
    check_length(min_depth, "the minimum depth");
    return std::make_unique<DepthFilter>(min_depth);
}

std::unique_ptr<Filter> make_exact_object_filter(const ShapedObjects& first, const ExactOptions& options,
                                                 const ShapedObjects* second) {
    const FloatingPointScope scope;
    check(options);
    return std::make_unique<ExactObjectFilter>(PosedPairs(first, second), options);
}

std::unique_ptr<Filter> make_exact_feature_filter(const ShapedObjects& first, const ExactOptions& options,
                                                  const ShapedObjects* second) {
    const FloatingPointScope scope;
    check(options);
    return std::make_unique<ExactFeatureFilter>(PosedPairs(first, second), options);
}

}  // namespace octopair
