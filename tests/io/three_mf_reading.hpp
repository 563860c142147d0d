// Reads 3MF files that tests make in memory.
#pragma once

#include <gtest/gtest.h>

#include <cstring>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include <fmt/format.h>

#include "io/meshes/three_mf/three_mf_scene.hpp"
#include "io/temporary.hpp"
#include "io/zip_writer.hpp"

namespace octopair::test {

using io::LoadedScene;
using io::MeshObjects;

inline constexpr const char* core_space = "http://schemas.microsoft.com/3dmanufacturing/core/2015/02";
inline constexpr const char* production_xmlns =
    "xmlns:p=\"http://schemas.microsoft.com/3dmanufacturing/production/2015/06\"";

/// Returns the relationships of a package.
inline std::string relationships_to(std::string_view target) {
    return fmt::format(
        "<Relationships xmlns=\"http://schemas.openxmlformats.org/package/2006/relationships\"><Relationship Id=\"r\" "
        "Type=\"http://schemas.microsoft.com/3dmanufacturing/2013/01/3dmodel\" Target=\"{}\"/></Relationships>",
        target);
}

/// Returns a tetrahedron: its corners are the origin and one on each axis.
inline std::string tetrahedron(std::string_view triangle_attributes = {}) {
    std::string text =
        "<mesh><vertices><vertex x=\"0\" y=\"0\" z=\"0\"/><vertex x=\"1\" y=\"0\" z=\"0\"/><vertex x=\"0\" y=\"1\" "
        "z=\"0\"/><vertex x=\"0\" y=\"0\" z=\"1\"/></vertices><triangles>";
    for (const char* const corners : {"021", "013", "032", "123"}) {
        text += fmt::format("<triangle v1=\"{}\" v2=\"{}\" v3=\"{}\" {}/>", corners[0], corners[1], corners[2],
                            triangle_attributes);
    }
    return text + "</triangles></mesh>";
}

/// Returns the XML of a part. `attributes`: of <model>.
inline std::string model_text(std::string_view resources, std::string_view items, std::string_view attributes = {}) {
    return fmt::format("<model xmlns=\"{}\" {}><resources>{}</resources><build>{}</build></model>", core_space,
                       attributes, resources, items);
}

/// Returns a package: the relationships, a start part, and other parts with their names.
inline std::string package_of(const std::string& start,
                              const std::vector<std::pair<std::string, std::string>>& others = {}) {
    ZipWriter zip;
    zip.add("_rels/.rels", relationships_to("/3D/3dmodel.model"));
    zip.add("3D/3dmodel.model", start);
    for (const auto& [name, text] : others) zip.add(name, text);
    return zip.bytes();
}

inline LoadedScene three_mf_scene(const std::string& file,
                                  const io::SceneContent& content = {MeshObjects::node, true, {}}) {
    Buffer<std::byte> bytes{file.size()};
    if (!file.empty()) std::memcpy(bytes.data(), file.data(), file.size());
    return io::parse_three_mf_scene("f.3mf", std::move(bytes), content, {});
}

inline std::string three_mf_refusal(const std::string& file, ErrorCode code = ErrorCode::bad_input) {
    return error_of(code, [&] { (void)three_mf_scene(file); });
}

inline Box3d three_mf_box(const LoadedScene& scene, std::size_t object = 0) {
    return std::get<Buffer<Box3d>>(scene.boxes)[object];
}

inline const shape::Mesh& three_mf_mesh(const LoadedScene& scene, std::size_t object = 0) {
    return std::get<shape::Mesh>(scene.shapes->shapes[scene.shapes->geometry[object]]);
}

}  // namespace octopair::test
