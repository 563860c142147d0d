#include "io/meshes/gltf/gltf_scene.hpp"

#include <algorithm>
#include <unordered_map>
#include <utility>

#include <fmt/format.h>

#include "io/files/failure.hpp"
#include "io/meshes/gltf/extensions.hpp"
#include "io/meshes/gltf/gltf_model.hpp"
#include "io/meshes/placed_meshes.hpp"

namespace octopair::io {

namespace {

using gltf::GltfFile;
using gltf::GltfModel;
using gltf::Instance;

/// Checks what a file needs. Returns whether Assimp must read it.
bool is_for_assimp(const GltfFile& file) {
    if (!file.version().starts_with('1') && !file.version().starts_with('2'))
        refuse(file.path(), fmt::format("is of glTF {}; octopair reads glTF 2 and 1.0", shown_text(file.version())));
    if (file.version().starts_with('1')) return true;
    gltf::check_required_extensions(file);
    return gltf::needs_assimp(file);
}

/// Returns the objects of a model. Takes its meshes and names; the labels stay in its tree.
PlacedMeshes placed_meshes(GltfModel& model) {
    PlacedMeshes placed{"node", {}, {}};
    std::unordered_map<std::uint64_t, std::size_t> numbers;
    for (Instance& instance : model.instances()) {
        const auto [number, is_new] = numbers.try_emplace(instance.mesh, placed.meshes.size());
        if (is_new) placed.meshes.push_back(std::move(model.mesh(instance).shared));
        placed.objects.push_back({.name = std::move(instance.name),
                                  .label = model.tree().nodes()[instance.node].label,
                                  .parent_label = model.tree().parent_label(instance.node),
                                  .pose = instance.pose,
                                  .mesh = number->second,
                                  .parent = model.tree().nodes()[instance.node].parent});
    }
    return placed;
}

LoadedScene scene_of(GltfFile& file, const SceneContent& content) {
    GltfModel model(file, content.progress);
    const double largest = model.largest_rounded();
    std::vector<std::string> warnings = model.warnings();
    PlacedMeshes placed = placed_meshes(model);
    LoadedScene scene = scene_of(placed, content, file.budget());
    scene.largest_rounded = largest;
    scene.warnings = std::move(warnings);
    scene.space = {UpAxis::y, "m"};
    return scene;
}

}  // namespace

bool is_gltf_ending(std::string_view ending) { return ending == ".gltf" || ending == ".glb"; }

bool may_be_gltf_for_assimp(const std::string& path) { return gltf::may_need_assimp(path); }

std::optional<LoadedScene> read_gltf_scene(const std::string& path, const SceneContent& content,
                                           const std::stop_token& stop) {
    GltfFile file(path, stop);
    if (is_for_assimp(file)) return std::nullopt;
    return scene_of(file, content);
}

std::optional<LoadedScene> parse_gltf_scene(const std::string& path, Buffer<std::byte> bytes,
                                            const SceneContent& content, const std::stop_token& stop) {
    GltfFile file(path, std::move(bytes), stop);
    if (is_for_assimp(file)) return std::nullopt;
    return scene_of(file, content);
}

std::optional<shape::Mesh> read_gltf_mesh(const std::string& path, LoadedScene& scene, const std::stop_token& stop) {
    GltfFile file(path, stop);
    if (is_for_assimp(file)) return std::nullopt;
    GltfModel model(file, {});
    scene.largest_rounded = std::max(scene.largest_rounded, model.largest_rounded());
    const std::vector<std::string> warnings = model.warnings();
    scene.warnings.insert(scene.warnings.end(), warnings.begin(), warnings.end());
    return whole_mesh_of(placed_meshes(model), file.budget());
}

}  // namespace octopair::io
