#include "shapes.hpp"

#include <array>
#include <utility>
#include <variant>

#include "arrays.hpp"
#include "bindings.hpp"
#include "call.hpp"
#include "octopair/filters.hpp"

namespace octopair::python {

namespace {

Geometry prepared(shape::Any shape) {
    const Unlocked unlocked;
    return Geometry(std::move(shape));
}

std::vector<Point3d> points_of(const py::array& points) {
    const auto rows = rows_of<Point3d, double>(points);
    return {rows.begin(), rows.end()};
}

shape::Mesh mesh_of(const py::array& vertices, const py::array& triangles) {
    const auto corners = rows_of<std::array<std::uint32_t, 3>, std::uint32_t>(triangles);
    return {points_of(vertices), {corners.begin(), corners.end()}};
}

Geometry mesh(const py::array& vertices, const py::array& triangles, double weld_tolerance) {
    shape::Mesh mesh = mesh_of(vertices, triangles);
    const Unlocked unlocked;
    if (weld_tolerance > 0) weld(mesh, weld_tolerance);
    return Geometry(std::move(mesh));
}

py::array_t<double> array_of_points(const std::vector<Point3d>& points) {
    return array_of<double>(std::vector(points), {3});
}

/// Returns the name of the static function that makes a shape, and its arguments.
struct Recipe {
    py::tuple operator()(const shape::Sphere& sphere) const { return py::make_tuple("sphere", sphere.radius); }
    py::tuple operator()(const shape::Box& box) const { return py::make_tuple("box", box.half_extents); }
    py::tuple operator()(const shape::Capsule& capsule) const {
        return py::make_tuple("capsule", capsule.radius, capsule.length);
    }
    py::tuple operator()(const shape::Cylinder& cylinder) const {
        return py::make_tuple("cylinder", cylinder.radius, cylinder.length);
    }
    py::tuple operator()(const shape::Cone& cone) const { return py::make_tuple("cone", cone.radius, cone.length); }
    py::tuple operator()(const shape::Ellipsoid& ellipsoid) const {
        return py::make_tuple("ellipsoid", ellipsoid.radii);
    }
    py::tuple operator()(const shape::Plane& plane) const {
        return py::make_tuple("plane", plane.normal, plane.offset);
    }
    py::tuple operator()(const shape::ConvexHull& hull) const {
        return py::make_tuple("hull", array_of_points(hull.points));
    }
    /// The mesh is welded already.
    py::tuple operator()(const shape::Mesh& mesh) const {
        return py::make_tuple("mesh", array_of_points(mesh.vertices),
                              array_of<std::uint32_t>(std::vector(mesh.triangles), {3}));
    }
};

/// Returns boxes of triangles (n, 9) in float32.
py::array triangle_boxes(const py::array& triangles) {
    const auto rows = rows_of<Triangle3d, double>(triangles);
    std::vector<Box3f> boxes;
    {
        const Unlocked unlocked;
        boxes = octopair::boxes_of(rows);
    }
    return array_of<float>(std::move(boxes), {6});
}

/// Returns poses (n, 3, 4) of places (n, 3) and quaternions (n, 4) or None.
py::array make_poses(const py::array& places, const py::object& turns) {
    const auto all = rows_of<Point3d, double>(places);
    const auto quaternions = optional_rows_of<std::array<double, 4>, double>(turns);
    std::vector<Pose> poses(all.size());
    for (std::size_t i = 0; i < all.size(); ++i) {
        poses[i] = quaternions.empty() ? make_pose(all[i]) : make_pose(all[i], quaternions[i]);
    }
    return array_of<double>(std::move(poses), {3, 4});
}

}  // namespace

PythonShapes::PythonShapes(std::vector<Geometry> geometries, py::tuple columns)
    : geometries_(std::move(geometries)), columns_(std::move(columns)) {
    objects_.geometries = geometries_;
    objects_.geometry = rows_of<std::uint32_t>(columns_[0].cast<py::array>());
    objects_.poses = rows_of<Pose, double>(columns_[1].cast<py::array>());
    objects_.end_poses = optional_rows_of<Pose, double>(columns_[2]);
    objects_.padding = optional_rows_of<double>(columns_[3]);
    check(objects_);
}

py::array PythonShapes::boxes() const {
    std::vector<Box3d> boxes;
    {
        const Unlocked unlocked;
        boxes = octopair::boxes_of(objects_);
    }
    return array_of<double>(std::move(boxes), {6});
}

py::tuple PythonShapes::boxes_with(const PythonShapes& second) const {
    JoinBoxes boxes;
    {
        const Unlocked unlocked;
        boxes = octopair::boxes_of(objects_, second.objects());
    }
    return py::make_tuple(array_of<double>(std::move(boxes.first), {6}),
                          array_of<double>(std::move(boxes.second), {6}));
}

void bind_shapes(py::module_& module) {
    py::class_<Geometry>(module, "Geometry")
        .def_static(
            "sphere", [](double radius) { return prepared(shape::Sphere{radius}); }, py::arg("radius"))
        .def_static(
            "box", [](const Point3d& half_extents) { return prepared(shape::Box{half_extents}); },
            py::arg("half_extents"))
        .def_static(
            "capsule",
            [](double radius, double length) {
                return prepared(shape::Capsule{radius, length});
            },
            py::arg("radius"), py::arg("length"))
        .def_static(
            "cylinder",
            [](double radius, double length) {
                return prepared(shape::Cylinder{radius, length});
            },
            py::arg("radius"), py::arg("length"))
        .def_static(
            "cone",
            [](double radius, double length) {
                return prepared(shape::Cone{radius, length});
            },
            py::arg("radius"), py::arg("length"))
        .def_static(
            "ellipsoid", [](const Point3d& radii) { return prepared(shape::Ellipsoid{radii}); }, py::arg("radii"))
        .def_static(
            "plane",
            [](const Point3d& normal, double offset) {
                return prepared(shape::Plane{normal, offset});
            },
            py::arg("normal"), py::arg("offset"))
        .def_static(
            "hull", [](const py::array& points) { return prepared(shape::ConvexHull{points_of(points)}); },
            py::arg("points"))
        .def_static("mesh", &mesh, py::arg("vertices"), py::arg("triangles"), py::arg("weld") = 0.0)
        .def_property_readonly("closed", &Geometry::closed)
        .def("recipe", [](const Geometry& geometry) { return std::visit(Recipe(), geometry.shape()); });
    py::class_<PythonShapes>(module, "Shapes")
        .def(py::init<std::vector<Geometry>, py::tuple>(), py::arg("geometries"), py::arg("columns"))
        .def("boxes", &PythonShapes::boxes)
        .def("boxes_with", &PythonShapes::boxes_with, py::arg("second"));
    module.def("triangle_boxes", &triangle_boxes, py::arg("triangles"));
    module.def("make_poses", &make_poses, py::arg("places"), py::arg("turns"));
}

}  // namespace octopair::python
