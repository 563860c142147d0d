// Reads boxes and paddings from .npy files (npy_header.hpp describes the format).
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <stop_token>
#include <string>
#include <string_view>

#include "base/memory.hpp"
#include "io/boxes/npy_header.hpp"
#include "io/files/input_file.hpp"
#include "io/loaded_scene.hpp"

namespace octopair::io {

/// Content of a scene array, by its shape.
struct SceneShape {
    std::uint64_t objects = 0;
    std::uint64_t frames = 1;
    bool moving = false;
    bool spheres = false;
};

/// Returns the content of an array of floats: boxes (n, 6), spheres (n, 4) or moving boxes (frames, n, 6).
/// Throws: Error{bad_input} that begins with `file`, for other arrays.
SceneShape scene_shape(const NpyHeader& header, std::string_view file);

/// The objects [begin, end) of a file.
struct ObjectRows {
    std::uint64_t begin = 0, end = 0;
};

/// A scene file that can be read in part.
class NpyScene {
public:
    /// Throws: Error{bad_input, io_failed}.
    explicit NpyScene(const std::string& path);

    const SceneShape& shape() const { return shape_; }
    bool wide() const { return header_.type == NpyType::float64; }

    /// Boxes of at least this size are mapped. Smaller ones are read, into memory with huge pages.
    static constexpr std::uint64_t min_mapped_bytes = std::uint64_t(1) << 28;

    /// Reads the objects `rows` in each frame, or maps them if they are large and adjacent in the file.
    /// Throws: Error{bad_input, io_failed, cancelled}.
    LoadedScene read(const ObjectRows& rows, const std::stop_token& stop,
                     std::uint64_t min_mapped = min_mapped_bytes) const;

private:
    template <typename Real>
    Buffer<Box<Real>> read_boxes(const ObjectRows& rows, const std::stop_token& stop, std::uint64_t min_mapped) const;
    template <typename Real>
    std::optional<Buffer<Box<Real>>> map_boxes(const ObjectRows& rows, std::uint64_t min_mapped) const;
    template <typename Real>
    void read_columns(const ObjectRows& rows, std::span<Real> values, const std::stop_token& stop) const;
    template <typename T>
    void read_rows(std::uint64_t first, std::span<T> rows, const std::stop_token& stop) const;

    InputFile file_;
    NpyHeader header_;
    SceneShape shape_;
};

/// Reads all objects of a file. Throws: Error{bad_input, io_failed, cancelled}.
LoadedScene read_npy_scene(const std::string& path, const std::stop_token& stop = {});

/// A moving scene that is read one frame at a time. In Fortran order, the numbers of a frame are all over the file, so the whole scene is
/// in memory.
class NpyFrames {
public:
    /// Opens a file. Returns nothing if its array has no frame axis. Throws: what read_npy_scene() throws.
    static std::optional<NpyFrames> open(const std::string& path);

    const SceneShape& shape() const { return shape_; }
    bool wide() const { return header_.type == NpyType::float64; }

    /// Reads the boxes of a frame. Float32 files can be read as float64, but not the other way round.
    /// Requires: `boxes` has one element per object.
    /// Throws: Error{bad_input} if the file was truncated after it was opened; Error{io_failed, cancelled}.
    void read(std::uint64_t frame, std::span<Box3f> boxes, const std::stop_token& stop) const;
    void read(std::uint64_t frame, std::span<Box3d> boxes, const std::stop_token& stop) const;

private:
    NpyFrames(InputFile file, NpyHeader header, const SceneShape& shape)
        : file_(std::move(file)), header_(std::move(header)), shape_(shape) {}

    template <typename Real>
    void read_rows(std::uint64_t first, std::span<Box<Real>> rows, const std::stop_token& stop) const;

    InputFile file_;
    NpyHeader header_;
    SceneShape shape_;
    LoadedScene whole_;  // in Fortran order: all frames
};

/// Reads paddings: an array of floats of shape (n,), finite and >= 0. Throws: what read_npy_scene() throws.
Buffer<double> read_padding(const std::string& path, const std::stop_token& stop = {});

}  // namespace octopair::io
