// Readers of inputs: boxes, scenes and rules.
#include <cmath>
#include <span>

#include "io/boxes/csv.hpp"
#include "io/boxes/npy.hpp"
#include "io/json/exclusion_rules.hpp"
#include "io/json/json_scene.hpp"
#include "near_miss/readers.hpp"
#include "octopair/error.hpp"

namespace octopair::test {

namespace {

void add(const Point3d& point, Values& values) {
    for (const double number : point) values.number(number);
}

/// Appends the shapes of a scene by their kinds.
struct ShapeWords {
    Values& values;

    void operator()(const shape::Sphere& sphere) const {
        values.word("sphere");
        values.number(sphere.radius);
    }
    void operator()(const shape::Box& box) const {
        values.word("box");
        add(box.half_extents, values);
    }
    void operator()(const shape::Capsule& capsule) const { round("capsule", capsule); }
    void operator()(const shape::Cylinder& cylinder) const { round("cylinder", cylinder); }
    void operator()(const shape::Cone& cone) const { round("cone", cone); }
    void operator()(const shape::Ellipsoid& ellipsoid) const {
        values.word("ellipsoid");
        add(ellipsoid.radii, values);
    }
    void operator()(const shape::Plane& plane) const {
        values.word("plane");
        add(plane.normal, values);
        values.number(plane.offset);
    }
    void operator()(const shape::ConvexHull& hull) const {
        values.word("convex_hull");
        for (const Point3d& point : hull.points) add(point, values);
    }
    void operator()(const shape::Mesh& mesh) const {
        values.word("mesh");
        for (const Point3d& point : mesh.vertices) add(point, values);
        for (const auto& triangle : mesh.triangles) {
            for (const std::uint32_t corner : triangle) values.whole(corner);
        }
    }

private:
    template <typename Shape>
    void round(std::string_view name, const Shape& shape) const {
        values.word(name);
        values.number(shape.radius);
        values.number(shape.length);
    }
};

void add(const Pose& pose, Values& values) {
    for (const auto& row : pose.rows) {
        for (std::size_t column = 0; column < 3; ++column) values.computed(row[column]);
        values.number(row[3]);
    }
}

void add_object(const io::LoadedScene& scene, std::size_t i, Values& values) {
    const io::LoadedShapes& shapes = *scene.shapes;
    values.text(scene.names[i]);
    std::visit(ShapeWords{values}, shapes.shapes[shapes.geometry[i]]);
    add(shapes.poses[i], values);
    add(shapes.end_poses.empty() ? shapes.poses[i] : shapes.end_poses[i], values);
    values.number(shapes.padding.empty() ? 0 : shapes.padding[i]);
    values.whole(shapes.groups.empty() ? io::LoadedShapes::default_groups : shapes.groups[i]);
    values.whole(shapes.masks.empty() ? io::LoadedShapes::default_mask : shapes.masks[i]);
    values.whole(shapes.parents[i]);
    values.text(scene.details.of(i, io::Detail::parent));
}

void add(const ColumnPatterns& patterns, Values& values) {
    for (std::size_t column = 0; column < patterns.size(); ++column) {
        if (!patterns[column]) continue;
        values.word(column == 0 ? "name" : io::word_of(io::all_details[column - 1]));
        values.text(*patterns[column]);
    }
}

}  // namespace

void read_csv(const NearMissFile& file, Values& values) {
    const Buffer<Box3d> boxes = io::parse_csv_boxes(file.content, "f");
    for (const Box3d& box : boxes.span()) {
        for (const auto& corner : {box.min, box.max}) {
            for (int axis = 0; axis < 3; ++axis) {
                // Engines refuse such boxes.
                if (!std::isfinite(corner[axis])) throw Error(ErrorCode::bad_input, "f: not finite");
                values.number(corner[axis]);
            }
        }
    }
}

void read_npy(const NearMissFile& file, Values& values) {
    const auto bytes = std::as_bytes(std::span(file.content));
    const io::NpyHeader header = io::parse_npy_header(bytes, bytes.size(), "f");
    const io::SceneShape shape = io::scene_shape(header, "f");
    values.word((header.big_endian ? ">" : "<") + std::string(io::type_text(header.type).substr(1)));
    values.word(header.fortran_order ? "F" : "C");
    values.word(shape.spheres ? "spheres" : shape.moving ? "moving" : "boxes");
    values.whole(shape.frames);
    values.whole(shape.objects);
    values.whole(header.data_offset);
}

void read_json_scene(const NearMissFile& file, Values& values) {
    const auto load = [&](const std::string& name) {
        values.word("file");
        values.text(name);
        return shape::Mesh{};
    };
    const io::LoadedScene scene = io::parse_json_scene(file.content, "f", load);
    for (std::size_t i = 0; i < scene.objects; ++i) add_object(scene, i, values);
}

void read_exclusion_rules(const NearMissFile& file, Values& values) {
    const io::ExclusionRules rules = io::parse_exclusion_rules(file.content, "f");
    for (const ColumnRule& rule : rules.exclude) {
        values.word("a");
        add(rule.a, values);
        values.word("b");
        add(rule.b, values);
    }
    for (const auto& names : rules.ignored_pairs) {
        values.word("pair");
        for (const std::string& name : names) values.text(name);
    }
    values.word(rules.same_parent ? "true" : "false");
}

}  // namespace octopair::test
