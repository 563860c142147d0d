// json_shape(): reads one shape of a JSON scene.
#include "io/json/json_scene.hpp"

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

/// Polls for a stop request once in many elements. Throws: Error{cancelled} soon after a stop request.
void check_stop(const std::stop_token& stop, std::size_t element) {
    constexpr std::size_t elements_between_checks = 4096;
    if (element % elements_between_checks == 0 && stop.stop_requested()) cancel();
}

bool is_point(const json& value) {
    return value.is_array() && value.size() == 3 && value[0].is_number() && value[1].is_number() &&
           value[2].is_number();
}

std::vector<Point3d> points(const JsonFields& fields, std::string_view key, const std::stop_token& stop) {
    const json::array_t& array = json_array(fields.required(key), fields.place_of(key));
    std::vector<Point3d> points;
    points.reserve(array.size());
    for (std::size_t i = 0; i < array.size(); ++i) {
        check_stop(stop, i);
        // The text of the place is made only after an error, because making it costs more than reading a point.
        points.push_back(
            json_point(array[i], is_point(array[i]) ? std::string() : fmt::format("{}[{}]", fields.place_of(key), i)));
    }
    return points;
}

shape::ConvexHull convex_hull(const JsonFields& fields, const std::stop_token& stop) {
    fields.allow({"type", "points"});
    shape::ConvexHull hull{points(fields, "points", stop)};
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

bool is_triangle(const json& value, std::size_t vertices) {
    const auto is_vertex = [&](const json& corner) {
        return corner.is_number_unsigned() && corner.get<std::uint64_t>() < vertices;
    };
    return value.is_array() && value.size() == 3 && is_vertex(value[0]) && is_vertex(value[1]) && is_vertex(value[2]);
}

shape::Mesh inline_mesh(const JsonFields& fields, const std::stop_token& stop) {
    shape::Mesh mesh;
    mesh.vertices = points(fields, "vertices", stop);
    const json::array_t& triangles = json_array(fields.required("triangles"), fields.place_of("triangles"));
    mesh.triangles.reserve(triangles.size());
    for (std::size_t i = 0; i < triangles.size(); ++i) {
        check_stop(stop, i);
        const bool is_valid = is_triangle(triangles[i], mesh.vertices.size());
        const std::string place = is_valid ? std::string() : fmt::format("{}: triangle {}", fields.place(), i);
        mesh.triangles.push_back(triangle(triangles[i], place, mesh.vertices.size()));
    }
    return mesh;
}

shape::Mesh mesh(const JsonFields& fields, const MeshLoader& load_mesh, const std::stop_token& stop) {
    if (fields.find("file") == nullptr) {
        fields.allow({"type", "vertices", "triangles", "file"});
        return inline_mesh(fields, stop);
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

shape::Any json_shape(const json& value, const std::string& place, const MeshLoader& load_mesh,
                      const std::stop_token& stop) {
    const JsonFields fields(value, place);
    const std::string& type = fields.text("type");
    if (type == "sphere") return sphere(fields);
    if (type == "box") return box(fields);
    if (type == "capsule") return capsule(fields);
    if (type == "cylinder") return round_shape<shape::Cylinder>(fields);
    if (type == "cone") return round_shape<shape::Cone>(fields);
    if (type == "ellipsoid") return ellipsoid(fields);
    if (type == "plane") return plane(fields);
    if (type == "convex_hull") return convex_hull(fields, stop);
    if (type == "mesh") return mesh(fields, load_mesh, stop);
    fields.refuse_key("type", fmt::format("'{}' is not a type of shape; types: sphere, box, capsule, cylinder, "
                                          "cone, ellipsoid, plane, convex_hull, mesh",
                                          shown_text(type)));
}

}  // namespace octopair::io
