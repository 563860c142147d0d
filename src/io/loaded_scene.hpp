// What scene files become in memory: boxes frame after frame, with names and shapes where the files had them.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "base/memory.hpp"
#include "io/loaded_shapes.hpp"
#include "octopair/objects.hpp"

namespace octopair::io {

/// Box i of frame f is boxes[f * objects + i]. Where there are shapes or triangles, boxes may be left to be made of them:
/// then there are none.
struct LoadedScene {
    std::variant<Buffer<Box3f>, Buffer<Box3d>> boxes;
    std::uint64_t objects = 0;  ///< in each frame
    std::uint64_t frames = 1;
    bool moving = false;                 ///< a file with a frame axis, though it may hold one frame only
    std::vector<std::string> names;      ///< empty, or one an object; objects of files without names have empty ones
    std::optional<LoadedShapes> shapes;  ///< if they were asked for, and the file has any
    std::optional<LoadedTriangles> triangles;  ///< likewise, where triangles are objects

    bool lacks_boxes() const {
        return objects > 0 && std::visit([](const auto& buffer) { return buffer.size() == 0; }, boxes);
    }

    /// The boxes of a frame, borrowed.
    Objects frame(std::uint64_t f) const {
        return std::visit(
            [&](const auto& buffer) {
                return Objects{buffer.span().subspan(std::size_t(f * objects), std::size_t(objects)), {}};
            },
            boxes);
    }
};

}  // namespace octopair::io
