// SceneContents and FrameFinder: a scene to show, independent of the files that it comes from.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "octopair/collision.hpp"
#include "octopair/objects.hpp"
#include "octopair/options.hpp"
#include "octopair/pose.hpp"
#include "octopair/shapes.hpp"

namespace octopair::viewer {

/// A shape as triangles, in its own coordinates, relative to `centre`.
struct ShownShape {
    std::string kind;     ///< for example "mesh"
    Point3d centre = {};  ///< vertices are relative to `centre`, so that float32 is precise enough
    std::vector<std::array<float, 3>> vertices;
    std::vector<std::array<std::uint32_t, 3>> triangles;
};

/// Returns the triangles of a shape. Round shapes become polyhedra. `extent`: length of the scene, which limits the drawing of a plane.
ShownShape shown_shape(const shape::Any& shape, double extent);

/// Facts for people: a name, and a number or a text. A name with a dot ("seconds.read") is a measured time, which exported pages do not
/// have: the same input gives the same page.
struct Fact {
    std::string name;
    double number = 0;
    std::string text = {};  ///< if not empty, in place of the number
};

/// Texts about objects, such as their types. Equal texts are stored once.
struct ObjectTexts {
    struct Column {
        std::string name;                  ///< for example "type"
        std::vector<std::uint32_t> words;  ///< one index into ObjectTexts::words per object
    };
    std::vector<std::string> words = {{}};  ///< distinct texts; the first is empty, for objects without a text
    std::vector<Column> columns;

    std::string_view of(const Column& column, std::uint32_t object) const {
        return object < column.words.size() ? std::string_view(words[column.words[object]]) : std::string_view();
    }
};

/// A file that a scene was read from. Its objects follow those of the file before it.
struct ShownFile {
    std::string name;
    std::uint64_t first;  ///< index of its first object
};

/// A collision of an older result that is gone. Its objects may no longer exist, so only texts and the finding are known.
struct GoneCollision {
    struct Object {
        std::string name, label, type, id;
    };
    std::array<Object, 2> objects;
    Finding finding;
};

/// The properties of a scene that are equal in all frames. Arrays have one element per object, or are empty.
struct SceneContents {
    std::string title;
    std::uint64_t objects = 0;
    bool contacts = false;  ///< true if collisions of some frame have contacts
    bool moving = false;    ///< true if pairs begin and end
    bool has_boxes = true;  ///< false if boxes only surround the contacts of their objects
    std::string up, unit;   ///< "y", "z" or empty; for example "m"
    double margin = 0;
    std::vector<std::string> names;
    std::vector<std::uint32_t> groups;
    ObjectTexts details;           ///< for example types and materials
    std::vector<ShownFile> files;  ///< in the order of their objects, or empty
    /// Number of the first object of the second set, if each pair has one object of each set. Results number both sets from 0.
    std::optional<std::uint64_t> second_set;
    std::vector<GoneCollision> gone;  ///< only exported pages have them
    std::vector<ShownShape> shapes;
    std::vector<std::uint32_t> geometry;  ///< index into `shapes`, or no_shape
    std::vector<Pose> poses;
    std::vector<std::string> notices;  ///< sentences for the reader
    std::vector<Fact> facts;           ///< for example seconds of reading

    static constexpr std::uint32_t no_shape = 0xFFFFFFFF;
};

/// Decision of people about a collision: a word, which is a static text, and a comment.
struct RowStatus {
    std::string_view status;
    std::string comment;
};

/// A frame and its result.
struct FrameData {
    Boxes boxes;                       ///< one per object
    std::vector<std::uint8_t> exists;  ///< 0 for objects that do not exist in this frame; empty: all exist
    std::span<const double> padding = {};
    std::shared_ptr<const void> keep;  ///< owner of the memory of `boxes`, or null
    std::vector<Pair> pairs;           ///< ascending; the first ones, if `pair_count` is larger
    std::vector<Finding> findings;     ///< one per pair, or empty
    std::vector<std::string_view>
        changes;  ///< one word per pair since an older result, such as "new", or empty; static texts
    std::vector<RowStatus> statuses;  ///< one per pair, or empty
    std::uint64_t pair_count = 0;
    std::vector<std::uint64_t> class_counts;  ///< number of pairs of each class; empty: those of `findings`
    bool more_pairs = false;                  ///< true if there are more than `pair_count`
    std::vector<Fact> facts;                  ///< for example seconds by step

    bool has(std::size_t object) const { return exists.empty() || exists[object] != 0; }
};

/// Finds the pairs of frames. Thread safety: one thread at a time.
class FrameFinder {
public:
    virtual ~FrameFinder() = default;
    virtual std::uint64_t frames() const = 0;
    /// Throws: Error of the search; Error{bad_input} for an invalid box.
    virtual FrameData find(std::uint64_t frame, const ProgressSink& progress) = 0;
};

}  // namespace octopair::viewer
