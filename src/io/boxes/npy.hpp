// Arrays of .npy files as boxes and paddings (npy_header.hpp has the format).
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

/// What an array of some shape holds.
struct SceneShape {
    std::uint64_t objects = 0;
    std::uint64_t frames = 1;
    bool moving = false;
    bool spheres = false;
};

/// Boxes (n, 6), spheres (n, 4) or moving boxes (frames, n, 6), of floats. Throws Error{bad_input} that begins with
/// `file`.
SceneShape scene_shape(const NpyHeader& header, std::string_view file);

/// Objects [begin, end) of a file.
struct ObjectRows {
    std::uint64_t begin = 0, end = 0;
};

/// A scene of which some objects are read.
class NpyScene {
public:
    /// Throws Error{bad_input, io_failed}.
    explicit NpyScene(const std::string& path);

    const SceneShape& shape() const { return shape_; }
    bool wide() const { return header_.type == NpyType::float64; }

    /// These objects, in each frame. Boxes are read where they will lie, without a second copy. Throws
    /// Error{bad_input, io_failed, cancelled}.
    LoadedScene read(const ObjectRows& rows, const std::stop_token& stop) const;

private:
    template <typename Real>
    Buffer<Box<Real>> read_boxes(const ObjectRows& rows, const std::stop_token& stop) const;
    template <typename T>
    void read_rows(std::uint64_t first, std::span<T> rows, const std::stop_token& stop) const;

    InputFile file_;
    NpyHeader header_;
    SceneShape shape_;
};

/// All of its objects. Throws Error{bad_input, io_failed, cancelled}.
LoadedScene read_npy_scene(const std::string& path, const std::stop_token& stop = {});

/// A moving scene, of which one frame at a time is read.
class NpyFrames {
public:
    /// Nothing if the file is an .npy of another shape. Throws as read_npy_scene does.
    static std::optional<NpyFrames> open(const std::string& path);

    const SceneShape& shape() const { return shape_; }
    bool wide() const { return header_.type == NpyType::float64; }

    /// Fills `boxes`, as many as there are objects, from a frame; those of float32 may be read as float64, but not the
    /// other way. Throws Error{bad_input} if the file has been cut short, Error{io_failed, cancelled}.
    void read(std::uint64_t frame, std::span<Box3f> boxes, const std::stop_token& stop) const;
    void read(std::uint64_t frame, std::span<Box3d> boxes, const std::stop_token& stop) const;

private:
    NpyFrames(InputFile file, NpyHeader header, const SceneShape& shape)
        : file_(std::move(file)), header_(std::move(header)), shape_(shape) {}

    template <typename T>
    void read_rows(std::uint64_t first, std::span<T> rows, const std::stop_token& stop) const {
        file_.read(header_.data_offset + first * sizeof(T), std::as_writable_bytes(rows), stop);
    }

    InputFile file_;
    NpyHeader header_;
    SceneShape shape_;
};

/// Clearances: shape (n,), floats, finite and >= 0. Throws as read_npy_scene does.
Buffer<double> read_padding(const std::string& path, const std::stop_token& stop = {});

}  // namespace octopair::io
