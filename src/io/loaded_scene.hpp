// LoadedScene: a scene in memory. Boxes of all frames, and the names, details and shapes that the files have.
//
// - Shapes and triangles are for the narrow phase. Objects have the same numbers as their boxes.
// - Objects with the same shape share one entry of `shapes`.
#pragma once

#include <algorithm>
#include <cstdint>
#include <optional>
#include <string>
#include <type_traits>
#include <utility>
#include <variant>
#include <vector>

#include "base/memory.hpp"
#include "io/files/file_mapping.hpp"
#include "io/formats/format_choice.hpp"
#include "io/object_details.hpp"
#include "io/object_relations.hpp"
#include "octopair/filters.hpp"
#include "octopair/objects.hpp"
#include "octopair/shapes.hpp"

namespace octopair::io {

/// Shapes, poses and attributes of n objects. Optional arrays are empty if no file sets a value.
struct LoadedShapes {
    std::vector<shape::Any> shapes;
    std::vector<std::uint32_t> geometry;  ///< n indices into `shapes`
    std::vector<Pose> poses;              ///< n poses
    std::vector<std::uint32_t> parents;   ///< n parent numbers; an object without a parent has a number of its own
    std::vector<Pose> end_poses;          ///< n poses at time 1, or empty; the default is the pose
    std::vector<double> padding;          ///< n paddings, or empty; the default is 0
    std::vector<std::uint32_t> groups;    ///< n bit masks, or empty; the default is bit 0
    std::vector<std::uint32_t> masks;     ///< n bit masks, or empty; the default is all bits

    static constexpr std::uint32_t default_groups = 1, default_mask = 0xFFFFFFFF;

    /// Appends the objects of `others`. Their numbers, and those of their shapes and parents, follow the numbers of this scene.
    void append(LoadedShapes&& others);
};

/// Triangles as objects, in the world (octopair/shapes.hpp).
struct LoadedTriangles {
    std::vector<Triangle3d> triangles;
    std::vector<std::uint32_t> owners;  ///< for each triangle, the node that it belongs to (an index into owner_names)
    std::vector<std::string> owner_names;  ///< names of all nodes, including nodes without triangles
    ObjectDetails owner_details;           ///< empty, or a row per node

    /// Appends the triangles of `others`. Their numbers, and those of their owners, follow the numbers of this scene.
    void append(LoadedTriangles&& others);
};

/// Number of elements of a type, for example "IFCSPACE".
struct TypeCount {
    std::string type;
    std::uint64_t count = 0;
};

/// Elements of one type that a file has with geometry, but that were not read.
struct LostElements {
    std::string file, type;
    std::uint64_t count = 0;
    std::string
        first;  ///< the first of them in the file: its id, and its name if it has one, for example "2O2Fr$t4X7Zf8NOew3FLR9 ('Wall 3')"
};

/// Elements of building models. An element may be several objects.
struct ElementCounts {
    std::uint64_t with_geometry =
        0;  ///< elements that the files have with geometry, without those left out on purpose; 0: not known
    std::uint64_t read = 0;           ///< elements among them that have at least one object
    std::vector<LostElements> lost;   ///< the others, by file and type, in the order of the first
    std::vector<TypeCount> left_out;  ///< elements that are left out on purpose, by type

    /// Says how many elements of one file are lost, of which types, and which are the first; empty if none is.
    std::string lost_text() const;
    /// Adds the counts of other files.
    void add(const ElementCounts& others);
};

/// Box i of frame f is boxes[f * objects + i]. Boxes of a large .npy file are mapped from the file. A scene with shapes or
/// triangles may have no boxes yet; the caller then computes the boxes from the shapes.
struct LoadedScene {
    std::variant<Buffer<Box3f>, Buffer<Box3d>> boxes;
    std::uint64_t objects = 0;  ///< number of objects in each frame
    std::uint64_t frames = 1;
    bool moving = false;  ///< true for a file with a frame axis, even with one frame
    /// Bound on the coordinates of meshes that the file or its reader rounded to float32; 0: no coordinates were rounded. The bound also
    /// covers coordinates before their transforms, in the unit of the world, and the translations of the transforms.
    double largest_rounded = 0;
    /// Greatest distance of a curved surface from the triangles that stand for it, or of a vertex from where it was before it was rounded, as
    /// far as the reader knows; 0: not known, or none.
    double chord = 0;
    std::vector<std::string> names;  ///< empty, or one name per object; an object without a name has an empty one
    ObjectDetails details;           ///< empty, or a row per object
    ObjectRelations relations;       ///< empty, or an element per object; empty for triangles
    SceneSpace space;                ///< axes and unit of the coordinates
    std::string converted_from;      ///< unit that the file states, if its coordinates were converted to another
    std::string project;             ///< id of the project, as an IFC file has it; empty if the format has none
    std::string root;  ///< first part of the names, if the reader took it from the name of the file; or empty
    /// Warnings of the readers, for example that a part of a file was not read. Each is one line "FILE: ...".
    std::vector<std::string> warnings;
    std::vector<std::string>
        not_read;            ///< content that readers left out, for example "IFCSPACE (3)"; for `octopair info`
    ElementCounts elements;  ///< elements of IFC models
    std::optional<LoadedShapes> shapes;        ///< set if SceneContent::shapes is set and the file has shapes
    std::optional<LoadedTriangles> triangles;  ///< set if SceneContent::shapes is set and triangles are the objects

    /// Sets the unit of the coordinates, which is `wanted` if they were converted to it from the unit of the file.
    void set_unit(const std::string& of_file, const std::string& wanted);

    bool lacks_boxes() const {
        return objects > 0 && std::visit([](const auto& buffer) { return buffer.size() == 0; }, boxes);
    }

    /// Throws: Error{bad_input} if the boxes are mapped (FileMapping) and the file was changed since it was opened.
    void check_mapped() const {
        std::visit([](const auto& buffer) { check_mapping(std::as_bytes(buffer.span())); }, boxes);
    }

    /// Copies mapped boxes into memory, so that they no longer change with the file.
    /// Throws: as check_mapped(); std::bad_alloc.
    void copy_mapped() {
        std::visit(
            [this](auto& buffer) {
                if (!is_mapped(std::as_bytes(buffer.span()))) return;
                std::remove_reference_t<decltype(buffer)> copy(buffer.size());
                std::copy(buffer.span().begin(), buffer.span().end(), copy.data());
                check_mapped();
                buffer = std::move(copy);
            },
            boxes);
    }

    /// Returns the boxes of frame `f`, borrowed.
    Objects frame(std::uint64_t f) const {
        return std::visit(
            [&](const auto& buffer) {
                return Objects{buffer.span().subspan(std::size_t(f * objects), std::size_t(objects)), {}};
            },
            boxes);
    }
};

}  // namespace octopair::io
