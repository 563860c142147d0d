// Arrays of .npy files as boxes and paddings (npy_header.hpp has the format).
#pragma once

#include <cstdint>
#include <span>
#include <stop_token>
#include <string>
#include <string_view>

#include "base/memory.hpp"
#include "io/loaded_scene.hpp"
#include "io/npy_header.hpp"

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

/// Boxes are read where they will lie, without a second copy. Throws Error{bad_input, io_failed, cancelled}.
LoadedScene read_npy_scene(const std::string& path, const std::stop_token& stop = {});

/// Clearances: shape (n,), floats, finite and >= 0. Throws as read_npy_scene does.
Buffer<double> read_padding(const std::string& path, const std::stop_token& stop = {});

}  // namespace octopair::io
