// A scene of shapes, and its collisions by the exact filters.
#pragma once

#include <gtest/gtest.h>

#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "narrow_phase/object_pair.hpp"
#include "octopair/filters.hpp"
#include "octopair/pipeline.hpp"
#include "samples/meshes.hpp"

namespace octopair::test {

using samples::box_mesh;

/// Owns the objects that ShapedObjects borrows.
struct Scene {
    std::vector<Geometry> geometries;
    std::vector<std::uint32_t> geometry;
    std::vector<Pose> poses, end_poses;
    std::vector<double> padding;

    void add(shape::Any shape, const Pose& pose = {}) {
        geometry.push_back(std::uint32_t(geometries.size()));
        geometries.emplace_back(std::move(shape));
        poses.push_back(pose);
    }
    ShapedObjects objects() const { return {geometries, geometry, poses, end_poses, padding}; }
    PosedObject object(std::uint32_t i) const { return {detail::prepared(geometries[geometry[i]]), poses[i]}; }
};

struct Collision {
    Pair pair;
    Finding finding;
};

inline std::vector<Collision> find(const Scene& scene, const ExactOptions& options = {}, unsigned threads = 2) {
    const ShapedObjects objects = scene.objects();
    const std::vector<Box3d> boxes = boxes_of(objects);
    Pipeline pipeline(threads);
    pipeline.add(make_exact_object_filter(objects, options));
    pipeline.add(make_exact_feature_filter(objects, options));
    std::vector<Collision> collisions;
    Options search{.margin = options.margin};
    pipeline.run(
        *make_local_engine(threads), {std::span(boxes), scene.padding},
        [&](const Batch& batch) {
            for (std::size_t i = 0; i < batch.pairs().size(); ++i) {
                collisions.push_back({batch.pairs()[i], batch.findings()[i]});
            }
        },
        search);
    return collisions;
}

/// Returns the only collision of two objects.
inline Finding collision_of(const Scene& scene, const ExactOptions& options = {}) {
    const std::vector<Collision> collisions = find(scene, options);
    EXPECT_EQ(collisions.size(), 1u);
    return collisions.empty() ? Finding{} : collisions[0].finding;
}

/// Makes two box meshes, the second at `place`.
inline Scene two_boxes(const Point3d& size_a, const Point3d& size_b, const Point3d& place) {
    Scene scene;
    scene.add(box_mesh({0, 0, 0}, size_a));
    scene.add(box_mesh({0, 0, 0}, size_b), make_pose(place));
    return scene;
}

}  // namespace octopair::test
