// Scene files of any kind, told apart by the ending of their names: .npy, .csv, .json, and what Assimp reads.
#pragma once

#include <optional>
#include <span>
#include <stop_token>
#include <string>

#include "io/boxes/npy.hpp"
#include "io/loaded_scene.hpp"

namespace octopair::io {

/// What one object of a mesh file is: a node that shows a mesh, or a triangle.
enum class MeshObjects : std::uint8_t { node, triangle };

/// What is wanted of files that hold more than boxes.
struct SceneContent {
    MeshObjects objects = MeshObjects::node;
    bool shapes = false;  ///< beside boxes, what the exact stages need: shapes, or triangles
};

/// Throws Error{bad_input, io_failed, resource_limit, cancelled}; the message begins with the file.
LoadedScene read_scene(const std::string& path, const SceneContent& content, const std::stop_token& stop = {});

/// Several scenes as one set: objects are numbered on, in each frame. Float32 beside float64 becomes float64, as all does
/// if `wide`. Where one lacks boxes, the set does. Throws Error{bad_input} where their frames do not agree, or where some
/// have shapes (or triangles) and others boxes alone.
LoadedScene join_scenes(std::span<LoadedScene> scenes, std::span<const std::string> paths, bool wide = false);

/// How many frames a set has; one that stands still has the same one for ever.
struct FrameCount {
    std::uint64_t frames = 1;
    bool moving = false;

    bool operator==(const FrameCount&) const = default;
};

/// Throws Error{bad_input} unless the files of one set all have the same.
void check_frame_counts(std::span<const FrameCount> counts, std::span<const std::string> paths);

/// A file of a moving scene, to be read frame by frame; nothing if it is of another kind. Throws as read_scene does.
std::optional<NpyFrames> open_frames(const std::string& path);

/// An object that is not a box, and why: "min x is nan, not a finite number".
struct Fault {
    std::uint64_t frame;
    std::uint64_t object;
    std::string what;
};

/// The first one, or nothing if all are boxes.
std::optional<Fault> find_fault(const LoadedScene& scene);
/// Of one frame, 0.
std::optional<Fault> find_fault(const Boxes& boxes);

}  // namespace octopair::io
