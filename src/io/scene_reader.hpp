// Reads scene files of any format (formats.hpp).
#pragma once

#include <functional>
#include <optional>
#include <span>
#include <stop_token>
#include <string>

#include "io/boxes/npy.hpp"
#include "io/loaded_scene.hpp"
#include "io/meshes/stream/reader_choice.hpp"

namespace octopair::io {

/// Kind of the objects of a mesh file: nodes with meshes, or triangles.
enum class MeshObjects : std::uint8_t { node, triangle };

/// Selects what to read from files that hold more than boxes.
struct SceneContent {
    MeshObjects objects = MeshObjects::node;
    bool shapes = false;  ///< also read shapes or triangles, for the narrow phase
    /// Receives the part of a file that is read, from 0 to 1; or empty. Only readers of plain meshes call it.
    std::function<void(double)> progress = {};
    /// Unit of the world. The coordinates of a file that states another unit are converted. Empty: the unit is that of the file.
    std::string unit = {};
    ReaderChoice reader = {};  ///< program that reads the files
};

/// Reads a scene file. Throws: Error{bad_input, io_failed, resource_limit, cancelled} that begins with the file.
LoadedScene read_scene(const std::string& path, const SceneContent& content, const std::stop_token& stop = {});

/// Joins scenes to one set. In each frame, the objects of a scene are numbered after those of the scenes before it.
/// The boxes are float64 if `wide` or if any scene is float64. The set has no boxes if any scene lacks boxes.
/// Throws: Error{bad_input} if the frames do not agree, or if only some scenes have shapes (or triangles).
LoadedScene join_scenes(std::span<LoadedScene> scenes, std::span<const std::string> paths, bool wide = false);

/// Number of frames of a set. A set that does not move has one frame, which is valid at all times.
struct FrameCount {
    std::uint64_t frames = 1;
    bool moving = false;

    bool operator==(const FrameCount&) const = default;
};

/// Checks that all files of one set have the same number of frames. Throws: Error{bad_input}.
void check_frame_counts(std::span<const FrameCount> counts, std::span<const std::string> paths);

/// Opens a moving scene for reading frame by frame. Returns nothing if the file is not a moving scene.
/// Throws: what read_scene() throws.
std::optional<NpyFrames> open_frames(const std::string& path);

/// An object whose box is invalid. `what` says why, for example "min x is nan, not a finite number".
struct InvalidBox {
    std::uint64_t frame;
    std::uint64_t object;
    std::string what;
};

/// Returns the first invalid box of the scene, or nothing if all boxes are valid.
std::optional<InvalidBox> find_invalid_box(const LoadedScene& scene);
/// Returns the first invalid box of one frame. InvalidBox::frame is 0.
std::optional<InvalidBox> find_invalid_box(const Boxes& boxes);

}  // namespace octopair::io
