// LoadedScene: a scene in memory. Boxes of all frames, and the names, details and shapes that the files have.
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
#include "io/formats.hpp"
#include "io/loaded_shapes.hpp"
#include "io/object_details.hpp"
#include "octopair/objects.hpp"

namespace octopair::io {

/// Box i of frame f is boxes[f * objects + i]. Boxes of a large .npy file are mapped from the file. A scene with shapes or
/// triangles may have no boxes yet; the caller then computes the boxes from the shapes.
struct LoadedScene {
    std::variant<Buffer<Box3f>, Buffer<Box3d>> boxes;
    std::uint64_t objects = 0;  ///< number of objects in each frame
    std::uint64_t frames = 1;
    bool moving = false;  ///< true for a file with a frame axis, even with one frame
    /// Bound on the coordinates of meshes that were rounded to float32, in the file or by its reader. 0: none were. Coordinates before
    /// transforms count, too, in the unit of the world, and so do the translations of the transforms.
    double largest_rounded = 0;
    std::vector<std::string> names;  ///< empty, or one name per object; an object without a name has an empty one
    ObjectDetails details;           ///< empty, or a row per object
    SceneSpace space;                ///< axes and unit of the coordinates
    /// Warnings of the readers, for example that a part of a file was not read. Each is one line "FILE: ...".
    std::vector<std::string> warnings;
    std::vector<std::string> not_read;   ///< what readers left out, for example "IFCSPACE (3)"; for `octopair info`
    std::optional<LoadedShapes> shapes;  ///< set if SceneContent::shapes is set and the file has shapes
    std::optional<LoadedTriangles> triangles;  ///< set if SceneContent::shapes is set and triangles are the objects

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
