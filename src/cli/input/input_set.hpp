// InputSet: the input files of the command line as one set of objects.
#pragma once

#include <memory>
#include <optional>
#include <stop_token>
#include <string>
#include <vector>

#include "io/loaded_scene.hpp"
#include "io/scene_reader.hpp"

namespace octopair::cli {

/// A file of a set, and its number of objects. Parts are in the order of the object numbers.
struct Part {
    std::string path;
    std::uint64_t objects;
    bool is_model = false;                ///< false: a file of boxes
    std::string unit = {};                ///< unit that the file states; empty if unknown
    std::string converted_from = {};      ///< this unit, if the coordinates were converted to that of the set
    std::string project = {}, root = {};  ///< LoadedScene::project, LoadedScene::root
};

class ShapedSet;

/// One of `slices` slices of a set. Slices have almost equal sizes.
struct SliceNumber {
    std::uint64_t slice = 0, slices = 1;

    std::uint64_t begin(std::uint64_t objects) const { return part(objects, slice); }
    std::uint64_t end(std::uint64_t objects) const { return part(objects, slice + 1); }

private:
    /// Returns objects * number / slices. Avoids the overflow of the product.
    std::uint64_t part(std::uint64_t objects, std::uint64_t number) const {
        return objects / slices * number + objects % slices * number / slices;
    }
};

struct InputSet {
    io::LoadedScene scene;
    std::shared_ptr<ShapedSet> shaped;  ///< prepared shapes, after make_shaped(); null in a build without the pipeline
    bool moves_meanwhile = false;       ///< true if objects move to end poses between time 0 and time 1
    std::vector<Part> parts;
    bool mixed_axes = false;               ///< true if the formats of the files have different axes up
    std::uint64_t begin = 0;               ///< for a slice, the number of its first object
    std::uint64_t total = 0;               ///< number of objects of all parts
    std::span<const double> padding = {};  ///< empty, or one padding per object; borrowed

    /// Returns the objects of frame `f`. A set that does not move has the same objects in every frame.
    Objects frame(std::uint64_t f) const;
    /// Returns the objects of a slice of frame `f`. Requires: the set is not a slice itself.
    Objects frame_slice(std::uint64_t f, const SliceNumber& number) const;
    /// Returns the smallest box that contains all boxes. For an empty set, its minima are infinite, and its maxima -infinite.
    Box3d bounds() const;
    /// The first invalid box of a set.
    struct InvalidBox {
        std::uint64_t position;  ///< frame * total + object
        std::string message;     ///< with the file and the object
    };
    /// Returns the first invalid box, or nothing if all boxes are valid.
    /// Throws: Error{bad_input} if the file of mapped boxes was changed.
    std::optional<InvalidBox> find_invalid_box() const;
};

/// The sets of a search. `second` is null unless the search is a join.
struct SetPair {
    const InputSet& first;
    const InputSet* second = nullptr;
};

/// Reads files as one set. The unit of the set is that of `content`, or without one that of the first file that states one. Files that state
/// another unit are converted. Sets of JSON scenes, and of triangles read with SceneContent::shapes, have no boxes until
/// make_shaped() computes them (shaped_set.hpp).
/// Requires: no other thread of this process runs (isolated_read.hpp). So read all sets before make_shaped().
/// Throws: what io::read_scene() and io::join_scenes() throw.
InputSet read_input_set(const std::vector<std::string>& paths, const io::SceneContent& content,
                        const std::stop_token& stop);

/// Selects a slice of a set.
struct SliceRequest {
    SliceNumber number;
    bool names = false;  ///< true: read the names of all objects of the set; false: read no names
};
/// Reads one slice of a set. From .npy files it reads only the objects of the slice.
/// Requires: no file is a JSON scene; the requirements of read_input_set().
/// Throws: what read_input_set() throws.
InputSet read_input_slice(const std::vector<std::string>& paths, const io::SceneContent& content,
                          const SliceRequest& wanted, const std::stop_token& stop);

}  // namespace octopair::cli
