// The files named on the command line, as one set of objects.
#pragma once

#include <optional>
#include <stop_token>
#include <string>
#include <vector>

#include "io/loaded_scene.hpp"
#include "io/scene_reader.hpp"

namespace octopair::cli {

/// How many objects each file brought, in the order of their numbers.
struct Part {
    std::string path;
    std::uint64_t objects;
};

struct InputSet {
    io::LoadedScene scene;
    std::vector<Part> parts;
    std::span<const double> padding = {};  ///< borrowed; empty, or one an object

    /// The objects of a frame; a set that does not move is the same in every frame.
    Objects frame(std::uint64_t f) const;
    /// Names the file and the object of it that is not a box, if there is one.
    std::optional<std::string> find_fault() const;
};

/// Throws what io::read_scene and io::join_scenes throw.
InputSet read_input_set(const std::vector<std::string>& paths, io::MeshObjects mesh_objects,
                        const std::stop_token& stop);

}  // namespace octopair::cli
