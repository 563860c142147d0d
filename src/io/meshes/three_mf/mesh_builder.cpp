#include "io/meshes/three_mf/mesh_builder.hpp"

#include <array>

#include <fmt/format.h>

#include "io/files/failure.hpp"
#include "io/meshes/three_mf/attributes.hpp"

namespace octopair::io::three_mf {

void MeshBuilder::begin(std::optional<Property> own) {
    mesh_ = {};
    properties_.clear();
    own_ = own;
    last_.reset();
    uses_own_ = false;
}

void MeshBuilder::add_vertex(const XmlTag& element, const XmlParser& parser) {
    constexpr std::array<std::string_view, 3> axes = {"x", "y", "z"};
    budget_.charge(1, sizeof(Point3d) + sizeof(std::uint32_t));
    Point3d place;
    for (std::size_t axis = 0; axis < 3; ++axis) {
        const char* const text = element.find(axes[axis]);
        if (text == nullptr) refuse_at(parser, fmt::format("vertex {} has no {}", mesh_.vertices.size(), axes[axis]));
        const auto number = parse_number(text);
        if (!number) {
            refuse_at(parser, fmt::format("vertex {}: {} is '{}', not a number within the range of float64",
                                          mesh_.vertices.size(), axes[axis], shown(text)));
        }
        place[axis] = *number;
    }
    mesh_.vertices.push_back(place);
}

bool MeshBuilder::add_triangle(const XmlTag& element, const XmlParser& parser) {
    constexpr std::array<std::string_view, 3> names = {"v1", "v2", "v3"};
    const std::size_t count = mesh_.triangles.size();
    budget_.charge(1, sizeof mesh_.triangles[0]);
    std::array<std::uint32_t, 3> corners;
    for (std::size_t k = 0; k < 3; ++k) {
        const char* const text = element.find(names[k]);
        if (text == nullptr) refuse_at(parser, fmt::format("triangle {} has no {}", count, names[k]));
        const auto number = parse_whole_number(text);
        if (!number) {
            refuse_at(parser,
                      fmt::format("triangle {}: {} is '{}', not the number of a vertex", count, names[k], shown(text)));
        }
        if (*number >= mesh_.vertices.size()) {
            refuse_at(parser,
                      fmt::format("triangle {}: {} is vertex {}, but {} vertices are before it; they count from 0",
                                  count, names[k], *number, mesh_.vertices.size()));
        }
        corners[k] = *number;
    }
    mesh_.triangles.push_back(corners);
    add_property(element);
    return corners[0] != corners[1] && corners[1] != corners[2] && corners[0] != corners[2];
}

/// Notes the material of a triangle. Ignores invalid numbers, because materials have no effect on shapes.
void MeshBuilder::add_property(const XmlTag& element) {
    const char* const index = element.find("p1");
    if (index == nullptr) {
        uses_own_ = true;
        return;
    }
    const char* const group = element.find("pid");
    const auto number = parse_whole_number(index);
    const auto id = group != nullptr ? parse_whole_number(group) : own_ ? std::optional(own_->first) : std::nullopt;
    if (!number || !id) return;
    const Property property(*id, *number);
    if (last_ == property) return;
    last_ = property;
    if (properties_.contains(property)) return;
    budget_.charge(1, sizeof(Property) + 4 * sizeof(void*));
    properties_.insert(property);
}

SharedMesh MeshBuilder::take() {
    if (own_ && (uses_own_ || mesh_.triangles.empty())) properties_.insert(*own_);
    SharedMesh taken;
    if (mesh_.triangles.empty()) {
        taken.loose = std::move(mesh_.vertices);
    } else {
        remove_unused_vertices(mesh_.vertices, {mesh_.triangles.front().data(), 3 * mesh_.triangles.size()});
        taken.triangles = std::move(mesh_);
    }
    mesh_ = {};
    return taken;
}

void refuse_at(const XmlParser& parser, std::string_view what) {
    refuse(parser.place(), fmt::format("line {}: {}", parser.line(), what));
}

}  // namespace octopair::io::three_mf
