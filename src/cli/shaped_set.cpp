#include "cli/shaped_set.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "octopair/error.hpp"

namespace octopair::cli {

namespace {

/// Says the file as well, where it is known.
template <typename Call>
auto with_file(const InputSet& set, const Call& call) {
    try {
        return call();
    } catch (const Error& error) {
        if (set.parts.size() != 1) throw;
        throw Error(error.code(), fmt::format("{}: {}", set.parts.front().path, error.what()));
    }
}

Buffer<Box3d> copy_of(const std::vector<Box3d>& boxes) {
    Buffer<Box3d> copy{boxes.size()};
    std::copy(boxes.begin(), boxes.end(), copy.data());
    return copy;
}

/// What is around all boxes of a set, as a set with a shape.
InputSet bounds_of(const InputSet& set) {
    constexpr double infinity = std::numeric_limits<double>::infinity();
    Point3d low{infinity, infinity, infinity}, high{-infinity, -infinity, -infinity};
    std::visit(
        [&](const auto& boxes) {
            for (const auto& box : boxes.span()) {
                for (std::size_t axis = 0; axis < 3; ++axis) {
                    low[axis] = std::min(low[axis], double(box.min[axis]));
                    high[axis] = std::max(high[axis], double(box.max[axis]));
                }
            }
        },
        set.scene.boxes);
    InputSet bounds;
    bounds.scene.shapes.emplace();
    for (std::size_t axis = 0; axis < 3; ++axis) {
        // No boxes, or some that the engine refuses.
        if (!(std::isfinite(low[axis]) && std::isfinite(high[axis]))) return bounds;
    }
    bounds.scene.shapes->shapes = {shape::ConvexHull{{low, high}}};
    bounds.scene.shapes->geometry = {0};
    bounds.scene.shapes->poses.resize(1);
    return bounds;
}

bool has_planes(const InputSet& set) {
    if (!set.scene.shapes) return false;
    const auto& shapes = set.scene.shapes->shapes;
    return std::any_of(shapes.begin(), shapes.end(),
                       [](const shape::Any& shape) { return std::holds_alternative<shape::Plane>(shape); });
}

}  // namespace

ShapedSet::ShapedSet(const InputSet& set) : loaded_(*set.scene.shapes) {
    geometries_.reserve(loaded_.shapes.size());
    with_file(set, [&] {
        for (const shape::Any& shape : loaded_.shapes) geometries_.emplace_back(shape);
    });
}

ShapedObjects ShapedSet::objects() const {
    return {geometries_, loaded_.geometry, loaded_.poses, loaded_.end_poses, loaded_.padding};
}

void make_boxes(InputSet& set) {
    if (!set.scene.lacks_boxes() || !set.scene.shapes) return;
    const ShapedSet shapes(set);
    set.scene.boxes = copy_of(with_file(set, [&] { return boxes_of(shapes.objects()); }));
}

void make_join_boxes(InputSet& first, InputSet& second) {
    if (!has_planes(first) && !has_planes(second)) return;
    const InputSet around_first = bounds_of(first), around_second = bounds_of(second);
    const ShapedSet first_shapes(first.scene.shapes ? first : around_first);
    const ShapedSet second_shapes(second.scene.shapes ? second : around_second);
    const JoinBoxes boxes = boxes_of(first_shapes.objects(), second_shapes.objects());
    if (has_planes(first)) first.scene.boxes = copy_of(boxes.first);
    if (has_planes(second)) second.scene.boxes = copy_of(boxes.second);
}

}  // namespace octopair::cli
