// Model of queries: computes the expected answers by a test of every object.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <set>
#include <utility>
#include <vector>

#include "scene/distance_oracle.hpp"
#include "scene/model.hpp"

namespace octopair::test {

/// Relation of a ray and a box, in higher precision than the library's. `close`: the ray nearly touches the box, and
/// both answers are right.
enum class RayResult { miss, close, hit };

inline RayResult cast(const Ray& ray, const Box3d& box, long double& along) {
    long double enter = 0, leave = ray.longest;
    for (int axis = 0; axis < 3; ++axis) {
        const long double origin = ray.origin[axis], direction = ray.direction[axis];
        if (direction == 0) {
            if (origin < box.min[axis] || origin > box.max[axis]) return RayResult::miss;
            continue;
        }
        const long double first = (box.min[axis] - origin) / direction, second = (box.max[axis] - origin) / direction;
        enter = std::max(enter, std::min(first, second));
        leave = std::min(leave, std::max(first, second));
    }
    along = enter;
    const long double rounding = 1e-14L * (std::abs(enter) + (std::isinf(leave) ? 0 : std::abs(leave))) + 1e-300L;
    if (enter <= leave) return double(enter) <= std::numeric_limits<double>::max() ? RayResult::hit : RayResult::close;
    return enter <= leave + rounding ? RayResult::close : RayResult::miss;
}

/// Makes queries at places near the objects and elsewhere, and compares the answers with the model's.
/// AnyScene: a class with the queries of Scene.
template <typename AnyScene>
class QueryModel {
public:
    QueryModel(const Model& model, AnyScene& scene, std::uint64_t seed) : scene_(scene), random_(seed) {
        for (const auto& [index, object] : model.objects) all_.push_back(&object);
    }

    void check() {
        for (int i = 0; i < 3; ++i) {
            groups_ = i == 0 ? Scene::all_groups : 1u << random_() % 3;
            check_overlaps(random_box());
            check_sphere();
            check_ray();
            check_nearest(random_box());
            if (::testing::Test::HasFatalFailure()) return;
        }
    }

private:
    bool wanted(const ModelObject& object) const { return (object.traits.groups & groups_) != 0; }
    double unit() { return std::uniform_real_distribution<>(0, 1)(random_); }
    Box3d object_box() { return all_.empty() ? Box3d{{0, 0, 0}, {1, 1, 1}} : all_[random_() % all_.size()]->box; }

    /// Returns the box of an object, a corner of a box, a point between two objects, or the box around two objects.
    Box3d random_box() {
        Box3d box = object_box();
        const Box3d other = object_box();
        const std::uint64_t how = random_() % 4;
        for (int axis = 0; axis < 3; ++axis) {
            if (how == 1) box.max[axis] = box.min[axis];
            if (how == 2) box.min[axis] = box.max[axis] = box.min[axis] + (other.max[axis] - box.min[axis]) * unit();
            if (!std::isfinite(box.min[axis])) box.min[axis] = box.max[axis] = 0;
            if (how == 3) {
                box.min[axis] = std::min(box.min[axis], other.min[axis]);
                box.max[axis] = std::max(box.max[axis], other.max[axis]);
            }
        }
        return box;
    }

    void check_overlaps(const Box3d& box) {
        std::vector<std::uint32_t> expected;
        for (const ModelObject* object : all_) {
            bool overlap = wanted(*object);
            for (int axis = 0; axis < 3; ++axis) {
                overlap = overlap && object->box.min[axis] <= box.max[axis] && box.min[axis] <= object->box.max[axis];
            }
            if (overlap) expected.push_back(object->id.index);
        }
        ASSERT_EQ(scene_.overlaps(box, groups_), expected);
    }

    void check_sphere() {
        const Box3d from = random_box(), to = object_box();
        Sphere sphere{{from.min[0], from.min[1], from.min[2]}, 0};
        sphere.radius =
            random_() % 2 == 0 ? rounded_distance(point_box(sphere.centre), to) : unit() * (from.max[0] - from.min[0]);
        if (!std::isfinite(sphere.radius)) return;
        std::vector<std::uint32_t> expected;
        for (const ModelObject* object : all_) {
            if (wanted(*object) && exactly_touches(sphere, object->box)) expected.push_back(object->id.index);
        }
        ASSERT_EQ(scene_.overlaps(sphere, groups_), expected);
    }

    void check_ray() {
        const Box3d from = random_box(), to = object_box();
        Ray ray{};
        for (int axis = 0; axis < 3; ++axis) {
            ray.origin[axis] = from.min[axis];
            ray.direction[axis] = random_() % 3 == 0 ? 0 : to.max[axis] - from.min[axis];
            if (!std::isfinite(ray.direction[axis])) ray.direction[axis] = 1;
        }
        if (ray.direction[0] == 0 && ray.direction[1] == 0 && ray.direction[2] == 0) ray.direction[random_() % 3] = -1;
        if (random_() % 2 == 0) ray.longest = random_() % 2 == 0 ? 1 : 2 * unit();

        const std::vector<RayHit> hits = scene_.all_hits(ray, groups_);
        std::set<std::uint32_t> found;
        for (const RayHit& hit : hits) ASSERT_TRUE(found.insert(hit.index).second) << "the ray hits an object twice";
        ASSERT_TRUE(std::is_sorted(hits.begin(), hits.end(), [](const RayHit& a, const RayHit& b) {
            return a.along != b.along ? a.along < b.along : a.index < b.index;
        }));
        std::size_t known = 0;
        for (const ModelObject* object : all_) {
            long double along = 0;
            const RayResult result = wanted(*object) ? cast(ray, object->box, along) : RayResult::miss;
            const bool is_found = found.contains(object->id.index);
            known += is_found ? 1 : 0;
            ASSERT_TRUE(result == RayResult::close || is_found == (result == RayResult::hit)) << object->id.index;
            if (!is_found) continue;
            const auto hit = std::find_if(hits.begin(), hits.end(),
                                          [&](const RayHit& one) { return one.index == object->id.index; });
            if (std::isfinite(hit->along)) {
                ASSERT_NEAR(double(along), hit->along, 1e-13 * std::abs(double(along)) + 1e-300);
            }
        }
        ASSERT_EQ(known, hits.size());
        const auto first = scene_.first_hit(ray, groups_);
        ASSERT_EQ(first.has_value(), !hits.empty());
        if (first) {
            ASSERT_EQ(*first, hits.front());
        }
    }

    void check_nearest(const Box3d& place) {
        std::vector<std::pair<Integer, std::uint32_t>> order;
        for (const ModelObject* object : all_) {
            if (wanted(*object)) order.emplace_back(exact_squared_distance(place, object->box), object->id.index);
        }
        const std::size_t count = std::min(order.size(), std::size_t(random_() % 12));
        std::partial_sort(order.begin(), order.begin() + std::ptrdiff_t(count), order.end());
        std::vector<Neighbor> expected;
        for (std::size_t i = 0; i < count; ++i) expected.push_back({order[i].second, rounded_distance(order[i].first)});
        ASSERT_EQ(scene_.nearest(place, count, groups_), expected);
        // The distance of one of the answers is the limit, or half of it.
        const double farthest = expected.empty() ? unit() : expected[random_() % expected.size()].distance;
        const NearestLimits limits{count, random_() % 2 == 0 ? farthest : farthest / 2};
        std::erase_if(expected, [&](const Neighbor& neighbor) { return neighbor.distance > limits.within; });
        Answers<Neighbor> answers;
        scene_.nearest(std::span(&place, 1), limits, answers, groups_);
        ASSERT_EQ(answers.all, expected);
    }

    AnyScene& scene_;
    std::mt19937_64 random_;
    std::vector<const ModelObject*> all_;
    std::uint32_t groups_ = Scene::all_groups;
};

}  // namespace octopair::test
