#include "io/meshes/gltf/gltf_mesh.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include <fmt/format.h>

#include "io/files/failure.hpp"
#include "io/meshes/gltf/fields.hpp"
#include "octopair/error.hpp"

namespace octopair::io::gltf {

namespace {

/// Kinds of primitives, with their numbers in glTF.
enum class Mode : std::uint8_t { points, lines, line_loop, line_strip, triangles, strip, fan };

constexpr bool has_triangles(Mode mode) { return mode >= Mode::triangles; }

/// Returns how many corners belong to complete faces, if a primitive has `corners` corners.
std::uint64_t used_corners(Mode mode, std::uint64_t corners) {
    const auto at_least = [&](std::uint64_t least) { return corners < least ? 0 : corners; };
    switch (mode) {
        case Mode::points:
            return corners;
        case Mode::lines:
            return corners - corners % 2;
        case Mode::line_loop:
        case Mode::line_strip:
            return at_least(2);
        case Mode::triangles:
            return corners - corners % 3;
        case Mode::strip:
        case Mode::fan:
            return at_least(3);
    }
    return 0;
}

std::uint64_t triangle_count(Mode mode, std::uint64_t used) {
    if (!has_triangles(mode) || used == 0) return 0;
    return mode == Mode::triangles ? used / 3 : used - 2;
}

/// Returns the corners of triangle `i`. In a strip, every second triangle is reversed, so that all triangles have the same side in front.
std::array<std::uint64_t, 3> corners_of(Mode mode, std::uint64_t i) {
    if (mode == Mode::triangles) return {3 * i, 3 * i + 1, 3 * i + 2};
    if (mode == Mode::fan) return {0, i + 1, i + 2};
    return i % 2 == 0 ? std::array{i, i + 1, i + 2} : std::array{i + 1, i, i + 2};
}

Mode mode_of(const JsonFields& fields) {
    const std::uint64_t mode = whole_number_or(fields, "mode", std::uint64_t(Mode::triangles));
    if (mode > std::uint64_t(Mode::fan))
        fields.refuse_key("mode", fmt::format("{} is not a mode of glTF, which are 0 to 6", mode));
    return Mode(mode);
}

}  // namespace

struct MeshDecoder::Primitive {
    std::string_view node;
    std::string place;  // place in the file, without the name of the file
    Accessor positions;
    std::optional<Accessor> indices;

    std::uint64_t corners() const { return indices ? indices->count() : positions.count(); }
};

void MeshDecoder::VertexNumbers::begin(std::uint64_t vertices) {
    ++primitive_;
    if (primitive_ == 0) used_in_.assign(used_in_.size(), primitive_++);
    if (vertices <= used_in_.size()) return;
    used_in_.resize(std::size_t(vertices));
    numbers_.resize(std::size_t(vertices));
}

std::pair<std::uint32_t, bool> MeshDecoder::VertexNumbers::number_of(std::uint64_t vertex, std::uint32_t next) {
    const bool is_new = std::exchange(used_in_[vertex], primitive_) != primitive_;
    if (is_new) numbers_[vertex] = next;
    return {numbers_[vertex], is_new};
}

GltfMesh MeshDecoder::decode(std::uint64_t number, std::string_view node) {
    const JsonFields fields = file_.item("meshes", number);
    const auto& primitives = json_array(fields.required("primitives"), fields.place_of("primitives"));
    GltfMesh mesh;
    for (std::size_t i = 0; i < primitives.size(); ++i) {
        const std::string place = fmt::format("{}.primitives[{}]", fields.place(), i);
        add_primitive(JsonFields(primitives[i], place), node, mesh);
    }
    for (const auto* const vertices : {&mesh.shared.triangles.vertices, &mesh.shared.loose}) {
        for (const Point3d& vertex : *vertices) {
            for (const double coordinate : vertex) mesh.largest = std::max(mesh.largest, std::abs(coordinate));
        }
    }
    return mesh;
}

void MeshDecoder::add_primitive(const JsonFields& fields, std::string_view node, GltfMesh& mesh) {
    const Mode mode = mode_of(fields);
    const JsonFields attributes(fields.required("attributes"), fields.place_of("attributes"));
    if (attributes.find("POSITION") == nullptr) return;
    Primitive primitive{node, fields.place().substr(file_.path().size() + 2),
                        Accessor(file_, whole_number(attributes, "POSITION"), 3), std::nullopt};
    if (fields.find("indices") != nullptr) {
        primitive.indices.emplace(file_, whole_number(fields, "indices"), 1);
        primitive.indices->check_indices();
    }
    if (fields.find("material") != nullptr) {
        const std::string material = name_in(file_.item("materials", whole_number(fields, "material")));
        if (!material.empty()) mesh.shared.materials.insert(material);
    }
    mesh.has_targets |= !array_or_empty(fields, "targets").empty();
    if (primitive.positions.is_float()) {
        mesh.has_floats = true;
    } else {
        mesh.step = std::max(mesh.step, primitive.positions.step());
    }
    const std::uint64_t corners = primitive.corners(), used = used_corners(mode, corners);
    if (used < corners && mesh.incomplete++ == 0) {
        mesh.first_incomplete = fmt::format("{}: its last {} of {} vertices make no complete face and are not read",
                                            primitive.place, corners - used, corners);
    }
    mesh.without_surface += !has_triangles(mode) && used > 0;
    const auto numbers =
        add_vertices(primitive, used, has_triangles(mode) ? mesh.shared.triangles.vertices : mesh.shared.loose);
    const std::uint64_t count = triangle_count(mode, used);
    auto& triangles = mesh.shared.triangles.triangles;
    file_.charge(count, sizeof triangles[0]);
    triangles.reserve(triangles.size() + count);
    for (std::uint64_t i = 0; i < count; ++i) {
        if (i % 65536 == 0) file_.checkpoint();
        const auto [a, b, c] = corners_of(mode, i);
        triangles.push_back({numbers[a], numbers[b], numbers[c]});
    }
}

std::vector<std::uint32_t> MeshDecoder::add_vertices(const Primitive& primitive, std::uint64_t corners,
                                                     std::vector<Point3d>& to) {
    constexpr std::uint32_t most = std::numeric_limits<std::uint32_t>::max();
    const Accessor& positions = primitive.positions;
    const auto refuse_index = [&](std::uint64_t corner, const std::string& what) {
        refuse(file_.path(),
               fmt::format("node '{}': {}: index {} is {}", primitive.node, primitive.place, corner, what));
    };
    file_.charge(corners, sizeof(std::uint32_t));
    std::vector<std::uint32_t> numbers;
    numbers.resize(std::size_t(corners));
    file_.charge(std::min(corners, positions.count()), sizeof(Point3d) + 2 * sizeof(std::uint32_t));
    numbers_.begin(positions.count());
    for (std::uint64_t corner = 0; corner < corners; ++corner) {
        if (corner % 65536 == 0) file_.checkpoint();
        const std::uint64_t vertex = primitive.indices ? primitive.indices->index_at(corner) : corner;
        if (primitive.indices && vertex == primitive.indices->largest_index())
            refuse_index(
                corner,
                fmt::format("{}, which glTF reserves to restart primitives; make each part a primitive of its own",
                            vertex));
        if (vertex >= positions.count())
            refuse_index(corner, fmt::format("vertex {}, but there are {} vertices", vertex, positions.count()));
        const auto [number, is_new] = numbers_.number_of(vertex, std::uint32_t(to.size()));
        numbers[corner] = number;
        if (!is_new) continue;
        if (to.size() == most) throw Error(ErrorCode::resource_limit, "a mesh has more than 2^32 - 1 vertices");
        to.push_back(positions.at<3>(vertex));
        for (const double coordinate : to.back()) {
            if (!std::isfinite(coordinate)) refuse_vertex(file_.path(), primitive.node, vertex, coordinate);
        }
    }
    return numbers;
}

void refuse_vertex(const std::string& file, std::string_view node, std::uint64_t vertex, double value) {
    refuse(file, fmt::format("node '{}': vertex {} has the coordinate {}, which is not finite", node, vertex,
                             number_text(value)));
}

}  // namespace octopair::io::gltf
