// Poses of nodes of glTF files and of their copies.
#pragma once

#include <array>
#include <optional>

#include "io/json/json_fields.hpp"
#include "octopair/pose.hpp"

namespace octopair::io::gltf {

/// A translation, a rotation as a quaternion x, y, z, w, and a scale: the form that glTF gives to transforms.
struct Placement {
    Point3d translation = {0, 0, 0};
    std::array<double, 4> rotation = {0, 0, 0, 1};
    Point3d scale = {1, 1, 1};
};

/// Returns the pose that scales, then rotates, then moves. `place`: for messages.
/// Throws: Error{bad_input} if a number is not finite or the quaternion has length 0.
Pose pose_of(const Placement& placement, const std::string& place);

/// Returns the pose of a node: its matrix, or its translation, rotation and scale.
/// Throws: Error{bad_input} that names the key.
Pose node_pose(const JsonFields& node);

}  // namespace octopair::io::gltf
