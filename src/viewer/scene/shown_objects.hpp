// ShownObjects: the overview of a scene: the objects that the page draws, in the order of the rows of its arrays.
//
// Invariants
//   Rows are in octal order of the boxes' centres, so a block of adjacent rows is near together in space.
//   The overview of a large scene has the largest objects, and every n-th of the smaller objects in octal order.
//   The choice depends on the boxes alone.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "octopair/objects.hpp"
#include "octopair/pose.hpp"
#include "viewer/scene/scene_contents.hpp"

namespace octopair::viewer {

/// Coordinates relative to an origin, as the page draws them.
struct RelativeBox {
    std::array<float, 6> ends;
};

/// Returns the smallest box that contains all objects of a frame; nothing if there are none.
std::optional<Box3d> bounds_of(const FrameData& frame);
/// Returns a box of extent 0 at 0, for scenes without objects.
inline Box3d no_bounds() { return {{0, 0, 0}, {0, 0, 0}}; }
/// Returns the smallest box that contains two boxes.
Box3d joined(const Box3d& a, const Box3d& b);
Point3d centre_of(const Box3d& box);
/// Returns an object's box in float64.
Box3d box_of(const Boxes& boxes, std::size_t object);
inline Box3d box_of(const FrameData& frame, std::size_t object) { return box_of(frame.boxes, object); }
/// Returns a box relative to an origin; its ends are rounded to the nearest float32.
RelativeBox relative(const Box3d& box, const Point3d& origin);
/// Returns the box that stands for an object that does not exist in a frame: all coordinates are NaN.
RelativeBox no_box();
inline bool overlap(const Box3d& a, const Box3d& b) {
    bool all = true;
    for (int i = 0; i < 3; ++i) all &= a.min[i] <= b.max[i] && b.min[i] <= a.max[i];
    return all;
}

class ShownObjects {
public:
    static constexpr std::uint32_t none = 0xFFFFFFFF;

    ShownObjects() = default;
    /// Chooses at most `most` objects of a frame.
    ShownObjects(const FrameData& frame, std::uint64_t objects, std::size_t most);

    /// Shows the first `count` objects, in order.
    static ShownObjects first(std::size_t count);

    std::size_t size() const { return objects_.size(); }
    /// Returns the object of each row.
    std::span<const std::uint32_t> objects() const { return objects_; }
    /// Returns the row of an object, or `none`.
    std::uint32_t row_of(std::uint32_t object) const { return object < rows_.size() ? rows_[object] : none; }
    /// Returns whether all objects are shown, in the order of their indices.
    bool in_order() const;

private:
    std::vector<std::uint32_t> objects_;  // by row
    std::vector<std::uint32_t> rows_;     // by object
};

}  // namespace octopair::viewer
