// Helpers for tests that read glTF files.
#pragma once

#include <gtest/gtest.h>

#include "io/gltf_builder.hpp"
#include "io/meshes/gltf/gltf_scene.hpp"

namespace octopair::test {

using io::Detail;
using io::LoadedScene;
using io::MeshObjects;
using Strings = std::vector<std::string>;

inline const io::SceneContent with_shapes{MeshObjects::node, true, {}};

inline LoadedScene scene_of(const std::string& text, const io::SceneContent& content = with_shapes) {
    auto scene = io::parse_gltf_scene("f.glb", as_buffer(text), content, {});
    EXPECT_TRUE(scene) << "only Assimp reads it";
    return scene ? std::move(*scene) : LoadedScene();
}
inline LoadedScene scene_of(const GltfBuilder& builder) { return scene_of(builder.text()); }

inline std::string refusal_of(const std::string& text) {
    return error_of(ErrorCode::bad_input, [&] { (void)scene_of(text); });
}
inline std::string refusal_of(const GltfBuilder& builder) { return refusal_of(builder.text()); }

inline void expect_part(const std::string& text, const std::string& part) { EXPECT_TRUE(has_text(text, part)); }
inline void expect_refusal(const GltfBuilder& builder, const std::string& part) {
    expect_part(refusal_of(builder), part);
}

inline const shape::Mesh& mesh_of(const LoadedScene& scene, std::size_t object = 0) {
    return std::get<shape::Mesh>(scene.shapes->shapes[scene.shapes->geometry[object]]);
}
inline Box3d box_at(const LoadedScene& scene, std::size_t object = 0) {
    return std::get<Buffer<Box3d>>(scene.boxes)[object];
}

/// Returns a file with one node whose mesh has the given accessor of positions.
template <typename T>
GltfBuilder with_positions(const std::vector<T>& values, GltfType type, bool normalized) {
    GltfBuilder builder;
    const json more = normalized ? json{{"normalized", true}} : json::object();
    builder.node({{"mesh", builder.mesh(builder.accessor(values, type, "VEC3", more))}});
    return builder;
}

}  // namespace octopair::test
