#include "cli/input/shaped_set.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>
#include <utility>

#include "octopair/error.hpp"
#include "parallel/team.hpp"

namespace octopair::cli {

ShapedSet::ShapedSet(io::LoadedShapes loaded, const HowToPrepare& how, const std::stop_token& stop)
    : loaded_(std::move(loaded)) {
    prepare(std::exchange(loaded_.shapes, {}), how, stop);
}

void ShapedSet::prepare(std::vector<shape::Any> shapes, const HowToPrepare& how, const std::stop_token& stop) {
    const std::vector<double> scale_of = how.weld > 0 ? scales(shapes.size()) : std::vector<double>();
    std::vector<std::optional<Geometry>> ready(shapes.size());
    Team(how.threads).for_each(shapes.size(), [&](std::size_t i, unsigned) {
        if (stop.stop_requested()) throw Error(ErrorCode::cancelled, "cancelled");
        auto* const mesh = std::get_if<shape::Mesh>(&shapes[i]);
        if (mesh != nullptr && how.weld > 0 && scale_of[i] > 0) weld(*mesh, how.weld / scale_of[i]);
        ready[i].emplace(std::move(shapes[i]));
    });
    geometries_.reserve(ready.size());
    for (auto& geometry : ready) geometries_.push_back(std::move(*geometry));
}

/// Returns the largest scale of the poses of each shape: the largest factor by which a pose lengthens an axis of the shape.
std::vector<double> ShapedSet::scales(std::size_t shapes) const {
    std::vector<double> largest(shapes, 0);
    for (std::size_t i = 0; i < loaded_.geometry.size(); ++i) {
        const std::uint32_t shape = loaded_.geometry[i];
        const auto& rows = loaded_.poses[i].rows;
        for (std::size_t axis = 0; axis < 3; ++axis) {
            largest[shape] = std::max(largest[shape], std::hypot(rows[0][axis], rows[1][axis], rows[2][axis]));
        }
    }
    return largest;
}

std::vector<std::uint32_t> ShapedSet::open_objects() const {
    std::vector<bool> open(geometries_.size());
    for (std::size_t i = 0; i < open.size(); ++i) open[i] = !geometries_[i].closed();
    std::vector<std::uint32_t> objects;
    for (std::uint32_t i = 0; i < loaded_.geometry.size(); ++i) {
        if (open[loaded_.geometry[i]]) objects.push_back(i);
    }
    return objects;
}

ShapedObjects ShapedSet::objects(std::span<const double> padding) const {
    return {geometries_, loaded_.geometry, loaded_.poses, loaded_.end_poses, padding};
}

bool ShapedSet::has_planes() const {
    return std::any_of(geometries_.begin(), geometries_.end(),
                       [](const Geometry& geometry) { return std::holds_alternative<shape::Plane>(geometry.shape()); });
}

GroupMasks ShapedSet::group_masks() {
    loaded_.groups.resize(loaded_.poses.size(), io::LoadedShapes::default_groups);
    loaded_.masks.resize(loaded_.poses.size(), io::LoadedShapes::default_mask);
    return {loaded_.groups, loaded_.masks};
}

namespace {

/// Runs `call`. If it throws an Error and the set has only one file, puts the name of the file before the message.
template <typename Call>
void with_file(const InputSet& set, const Call& call) {
    try {
        call();
    } catch (const Error& error) {
        if (error.code() != ErrorCode::bad_input || set.parts.size() != 1) throw;
        throw Error(error.code(), fmt::format("{}: {}", set.parts.front().path, error.what()));
    }
}

template <typename AnyBox>
Buffer<AnyBox> copy_of(const std::vector<AnyBox>& boxes) {
    Buffer<AnyBox> copy{boxes.size()};
    std::copy(boxes.begin(), boxes.end(), copy.data());
    return copy;
}

/// Returns a shape with the bounds of all boxes of a set. Returns no shape if the set is empty or has invalid boxes.
io::LoadedShapes bounds_of(const InputSet& set) {
    const Box3d box = set.bounds();
    io::LoadedShapes bounds;
    for (std::size_t axis = 0; axis < 3; ++axis) {
        if (!(std::isfinite(box.min[axis]) && std::isfinite(box.max[axis]))) return bounds;
    }
    bounds.shapes = {shape::ConvexHull{{{box.min[0], box.min[1], box.min[2]}, {box.max[0], box.max[1], box.max[2]}}}};
    bounds.geometry = {0};
    bounds.poses.resize(1);
    return bounds;
}

bool has_planes(const InputSet& set) { return set.shaped != nullptr && set.shaped->has_planes(); }

}  // namespace

void make_shaped(InputSet& set, const HowToPrepare& how, const std::stop_token& stop) {
    if (set.scene.triangles && set.scene.lacks_boxes())
        set.scene.boxes = copy_of(boxes_of(set.scene.triangles->triangles, how.threads));
    if (!set.scene.shapes) return;
    set.moves_meanwhile = !set.scene.shapes->end_poses.empty();
    with_file(set, [&] {
        set.shaped = std::make_shared<ShapedSet>(std::move(*std::exchange(set.scene.shapes, {})), how, stop);
        set.padding = set.shaped->padding();
        if (set.scene.lacks_boxes()) set.scene.boxes = copy_of(boxes_of(set.shaped->objects()));
    });
}

void make_shaped(InputSet& first, InputSet& second, const HowToPrepare& how, const std::stop_token& stop) {
    make_shaped(first, how, stop);
    make_shaped(second, how, stop);
    if (!has_planes(first) && !has_planes(second)) return;
    const ShapedSet around_first(bounds_of(first), {1}, {}), around_second(bounds_of(second), {1}, {});
    const ShapedSet& first_shapes = first.shaped != nullptr ? *first.shaped : around_first;
    const ShapedSet& second_shapes = second.shaped != nullptr ? *second.shaped : around_second;
    const JoinBoxes boxes = boxes_of(first_shapes.objects(), second_shapes.objects());
    if (has_planes(first)) first.scene.boxes = copy_of(boxes.first);
    if (has_planes(second)) second.scene.boxes = copy_of(boxes.second);
}

}  // namespace octopair::cli
