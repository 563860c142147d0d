// The files named on the command line, as one set of objects.
#pragma once

#include <memory>
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

class ShapedSet;

/// One of so many even parts of a set.
struct SliceNumber {
    std::uint64_t slice = 0, slices = 1;

    std::uint64_t begin(std::uint64_t objects) const { return part(objects, slice); }
    std::uint64_t end(std::uint64_t objects) const { return part(objects, slice + 1); }

private:
    /// objects * number / slices, without the product.
    std::uint64_t part(std::uint64_t objects, std::uint64_t number) const {
        return objects / slices * number + objects % slices * number / slices;
    }
};

struct InputSet {
    io::LoadedScene scene;
    std::shared_ptr<ShapedSet> shaped;  ///< what became of the scene's shapes, in a program with a pipeline
    bool moves_meanwhile = false;       ///< some shapes have a place at time 1 as well
    std::vector<Part> parts;
    std::uint64_t begin = 0;               ///< objects of the parts before those of the scene, where it is a slice
    std::uint64_t total = 0;               ///< objects of all parts
    std::span<const double> padding = {};  ///< borrowed; empty, or one an object

    /// The objects of a frame; a set that does not move is the same in every frame.
    Objects frame(std::uint64_t f) const;
    /// Of a whole set, those of a slice.
    Objects frame_slice(std::uint64_t f, const SliceNumber& number) const;
    /// Names the file and the object of it that is not a box, if there is one.
    std::optional<std::string> find_fault() const;
    /// Where it stands: an object, counted on from frame to frame.
    std::optional<std::uint64_t> fault_position() const;
};

/// Reads files. Sets of JSON scenes, and of triangles with what the exact stages need (SceneContent::shapes), lack boxes until
/// make_shaped() makes them (shaped_set.hpp). Throws what io::read_scene and io::join_scenes throw.
/// Requires: no other thread of this process is at work (isolated_read.hpp). Read all sets before the shapes of one are made.
InputSet read_input_set(const std::vector<std::string>& paths, const io::SceneContent& content,
                        const std::stop_token& stop);

/// The objects of a slice of the set, of any files but JSON scenes; of .npy files no others are read. `names`: whether the
/// scene gets the names of all objects of the set, or of none.
struct SliceRequest {
    SliceNumber number;
    bool names = false;
};
InputSet read_input_slice(const std::vector<std::string>& paths, const io::SceneContent& content,
                          const SliceRequest& wanted, const std::stop_token& stop);

}  // namespace octopair::cli
