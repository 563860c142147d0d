#include "io/json/json_shape.hpp"

#include <cmath>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "io/files/failure.hpp"
#include "io/json/json_fields.hpp"
#include "octopair/error.hpp"

namespace octopair::io {

namespace {

using nlohmann::json;

shape::Sphere sphere(const JsonFields& fields) {
    fields.allow({"type", "radius"});
    return {fields.above_zero("radius")};
}

shape::Box box(const JsonFields& fields) {
    fields.allow({"type", "half_extents"});
    return {fields.point_above_zero("half_extents")};
}

shape::Capsule capsule(const JsonFields& fields) {
    fields.allow({"type", "radius", "length"});
    return {fields.above_zero("radius"), fields.at_least_zero("length")};
}

template <typename Shape>
Shape round_shape(const JsonFields& fields) {
    fields.allow({"type", "radius", "length"});
    return {fields.above_zero("radius"), fields.above_zero("length")};
}

shape::Ellipsoid ellipsoid(const JsonFields& fields) {
    fields.allow({"type", "radii"});
    return {fields.point_above_zero("radii")};
}

shape::Plane plane(const JsonFields& fields) {
    fields.allow({"type", "normal", "offset"});
    const shape::Plane plane = {fields.point("normal"), fields.number("offset")};
    if (plane.normal == Point3d{0, 0, 0}) fields.refuse_key("normal", "0, 0, 0 is not a direction");
    return plane;
}

std::vector<Point3d> points(const JsonFields& fields, std::string_view key) {
    const std::string place = fields.place_of(key);
    const json::array_t& array = json_array(fields.need(key), place);
    std::vector<Point3d> points;
    points.reserve(array.size());
    for (std::size_t i = 0; i < array.size(); ++i) points.push_back(json_point(array[i], place));
    return points;
}

shape::ConvexHull convex_hull(const JsonFields& fields) {
    fields.allow({"type", "points"});
    shape::ConvexHull hull{points(fields, "points")};
    if (hull.points.empty()) fields.refuse_key("points", "the list is empty; a hull needs at least one point");
    return hull;
}

std::array<std::uint32_t, 3> triangle(const json& value, const std::string& place, std::size_t vertices) {
    const json::array_t& corners = json_array(value, place);
    if (corners.size() != 3) refuse(place, fmt::format("{} vertices, not 3", corners.size()));
    std::array<std::uint32_t, 3> triangle;
    for (std::size_t k = 0; k < 3; ++k) {
        triangle[k] = json_index(corners[k], place);
        if (triangle[k] >= vertices)
            refuse(place, fmt::format("vertex {} does not exist; the mesh has {} vertices", triangle[k], vertices));
    }
    return triangle;
}

shape::Mesh inline_mesh(const JsonFields& fields) {
    shape::Mesh mesh;
    mesh.vertices = points(fields, "vertices");
    const json::array_t& triangles = json_array(fields.need("triangles"), fields.place_of("triangles"));
    mesh.triangles.reserve(triangles.size());
    for (std::size_t i = 0; i < triangles.size(); ++i) {
        mesh.triangles.push_back(
            triangle(triangles[i], fmt::format("{}: triangle {}", fields.place(), i), mesh.vertices.size()));
    }
    return mesh;
}

shape::Mesh mesh(const JsonFields& fields, const MeshLoader& load_mesh) {
    if (fields.find("file") == nullptr) {
        fields.allow({"type", "vertices", "triangles", "file"});
        return inline_mesh(fields);
    }
    for (const std::string_view key : {"vertices", "triangles"}) {
        if (fields.find(key) != nullptr) fields.refuse_key(key, "not allowed together with 'file'");
    }
    fields.allow({"type", "file"});
    try {
        return load_mesh(fields.text("file"));
    } catch (const Error& error) {
        throw Error(error.code(), fmt::format("{}: {}", fields.place(), error.what()));
    }
}

}  // namespace

shape::Any json_shape(const json& value, const std::string& place, const MeshLoader& load_mesh) {
    const JsonFields fields(value, place);
    const std::string& type = fields.text("type");
    if (type == "sphere") return sphere(fields);
    if (type == "box") return box(fields);
    if (type == "capsule") return capsule(fields);
    if (type == "cylinder") return round_shape<shape::Cylinder>(fields);
    if (type == "cone") return round_shape<shape::Cone>(fields);
    if (type == "ellipsoid") return ellipsoid(fields);
    if (type == "plane") return plane(fields);
    if (type == "convex_hull") return convex_hull(fields);
    if (type == "mesh") return mesh(fields, load_mesh);
    fields.refuse_key("type", fmt::format("'{}' is not a type of shape; types: sphere, box, capsule, cylinder, "
                                          "cone, ellipsoid, plane, convex_hull, mesh",
                                          shown_text(type)));
}

}  // namespace octopair::io
