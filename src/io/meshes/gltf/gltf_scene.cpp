#include "io/meshes/gltf/gltf_scene.hpp"

#include <algorithm>
#include <cstdint>
#include <functional>
#include <string>
#include <unordered_map>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "io/files/failure.hpp"
#include "io/meshes/gltf/fields.hpp"
#include "io/meshes/gltf/gltf_file.hpp"
#include "io/meshes/gltf/gltf_mesh.hpp"
#include "io/meshes/gltf/node_tree.hpp"
#include "io/meshes/placed_meshes.hpp"

namespace octopair::io::gltf {

namespace {

using nlohmann::json;

/// Returns for each node whether it is an instance, or above an instance.
std::vector<bool> nodes_of_instances(const NodeTree& tree) {
    std::vector<bool> found(tree.nodes().size());
    for (const Instance& instance : tree.instances()) {
        for (std::size_t node = instance.node; node != Node::no_parent && !found[node];
             node = tree.nodes()[node].parent)
            found[node] = true;
    }
    return found;
}

/// Returns for each element of the array "nodes" whether an animation moves it. Skips invalid parts of animations, because animations
/// are not read.
std::vector<bool> animated_nodes(const GltfFile& file) {
    std::vector<bool> animated(file.count("nodes"));
    const json& root = file.root();
    const auto none = json::array();
    for (const json& animation : root.contains("animations") ? root["animations"] : none) {
        if (!animation.is_object() || !animation.contains("channels")) continue;
        std::size_t channels = 0;
        for (const json& channel : animation["channels"]) {
            if (++channels % 4096 == 0) file.checkpoint();
            const json* const node = channel.is_object() && channel.contains("target") &&
                                             channel["target"].is_object() && channel["target"].contains("node")
                                         ? &channel["target"]["node"]
                                         : nullptr;
            if (node == nullptr || !node->is_number_unsigned()) continue;
            if (node->get<std::uint64_t>() < animated.size()) animated[node->get<std::uint64_t>()] = true;
        }
    }
    return animated;
}

/// Returns for example "2 nodes have skins". Empty if `count` is 0.
std::string counted(std::size_t count, std::string_view one, std::string_view many) {
    if (count == 0) return {};
    return count == 1 ? fmt::format("1 node {}", one) : fmt::format("{} nodes {}", count, many);
}

bool is_identity(const BoundedPose& pose) { return pose.value().rows == Pose().rows; }

/// The instances of a glTF file with their decoded meshes.
class GltfModel {
public:
    /// Reads all meshes that instances have, each once. `progress` receives the part that was read, from 0 to 1; it may be empty.
    /// Throws: Error{bad_input, io_failed, resource_limit, cancelled}.
    GltfModel(GltfFile& file, const std::function<void(double)>& progress);

    GltfFile& file() const { return file_; }
    const NodeTree& tree() const { return tree_; }
    /// Returns the instances whose meshes have vertices.
    const std::vector<Instance>& instances() const { return tree_.instances(); }
    std::vector<Instance>& instances() { return tree_.instances(); }
    GltfMesh& mesh(const Instance& instance) { return meshes_[numbers_.at(instance.mesh)]; }
    const GltfMesh& mesh(const Instance& instance) const { return meshes_[numbers_.at(instance.mesh)]; }

    /// Returns LoadedScene::largest_rounded.
    double largest_rounded() const;
    /// Returns what a user should know, each one line "FILE: ...".
    std::vector<std::string> warnings() const;

private:
    std::string warning_of_incomplete_faces() const;
    std::string warning_of_motion() const;
    std::string warning_of_hidden_nodes() const;
    std::string warning_of_points() const;
    std::string warning_of_steps() const;

    GltfFile& file_;
    NodeTree tree_;
    std::vector<GltfMesh> meshes_;
    std::unordered_map<std::uint64_t, std::size_t> numbers_;  // index in the array "meshes" -> index in meshes_
};

GltfModel::GltfModel(GltfFile& file, const std::function<void(double)>& progress) : file_(file), tree_(file) {
    MeshDecoder decoder(file);
    std::vector<Instance>& instances = tree_.instances();
    for (std::size_t i = 0; i < instances.size(); ++i) {
        if (i % 1024 == 0) file.checkpoint();
        const auto [number, is_new] = numbers_.try_emplace(instances[i].mesh, meshes_.size());
        if (!is_new) continue;
        meshes_.push_back(decoder.decode(instances[i].mesh, instances[i].name));
        if (progress) progress(double(i + 1) / double(instances.size()));
    }
    std::erase_if(instances, [this](const Instance& instance) { return mesh(instance).shared.empty(); });
}

// A file rounds floats to float32. Its transforms count as rounded, too, because exporters compute them in float32: so they count for all
// coordinates that they move. Integers in a node without a transform are exact. The distance between neighbouring integers is not part
// of this bound. Otherwise the default tolerance would be as large as this distance, and hide overlaps of coarse parts.
double GltfModel::largest_rounded() const {
    double largest = 0;
    for (const Instance& instance : instances()) {
        const GltfMesh& own = mesh(instance);
        if (!own.has_floats && is_identity(instance.pose)) continue;
        largest = std::max(largest, instance.translations + instance.pose.largest_scale() * own.largest);
    }
    return largest;
}

std::vector<std::string> GltfModel::warnings() const {
    std::vector<std::string> lines;
    const auto add = [&](const std::string& line) {
        if (!line.empty()) lines.push_back(fmt::format("{}: {}", file_.path(), line));
    };
    add(tree_.note());
    add(warning_of_incomplete_faces());
    add(warning_of_motion());
    add(warning_of_hidden_nodes());
    add(warning_of_points());
    add(warning_of_steps());
    return lines;
}

std::string GltfModel::warning_of_incomplete_faces() const {
    std::size_t count = 0;
    std::string first;
    for (const GltfMesh& mesh : meshes_) {
        if (count == 0) first = mesh.first_incomplete;
        count += mesh.incomplete;
    }
    return count < 2 ? first : fmt::format("{}; so are those of {} more primitives", first, count - 1);
}

std::string GltfModel::warning_of_motion() const {
    const std::vector<bool> read = nodes_of_instances(tree_), animated = animated_nodes(file_);
    std::size_t skins = 0, targets = 0, animations = 0, last = Node::no_parent;
    for (std::size_t i = 0; i < read.size(); ++i) animations += read[i] && animated[tree_.nodes()[i].number];
    for (const Instance& instance : instances()) {
        if (std::exchange(last, instance.node) == instance.node) continue;  // a further copy of a node that was counted
        skins += tree_.nodes()[instance.node].has_skin;
        targets += mesh(instance).has_targets;
    }
    std::vector<std::string> parts = {counted(skins, "has a skin", "have skins"),
                                      counted(targets, "has morph targets", "have morph targets"),
                                      counted(animations, "is animated", "are animated")};
    std::erase(parts, "");
    if (parts.empty()) return {};
    return fmt::format("{}; this is not applied: their geometry at rest is read", fmt::join(parts, ", "));
}

std::string GltfModel::warning_of_hidden_nodes() const {
    std::size_t hidden = 0, last = Node::no_parent;
    for (const Instance& instance : instances()) {
        if (std::exchange(last, instance.node) == instance.node) continue;  // a further copy of a node that was counted
        hidden += tree_.nodes()[instance.node].is_hidden;
    }
    if (hidden == 0) return {};
    return fmt::format(
        "{} ({}); {} read like all others, because visibility is about pictures. Rules (--exclude) can leave "
        "{} out",
        counted(hidden, "is not visible", "are not visible"), visibility, hidden == 1 ? "it is" : "they are",
        hidden == 1 ? "it" : "them");
}

std::string GltfModel::warning_of_points() const {
    std::size_t count = 0;
    for (const GltfMesh& mesh : meshes_) count += mesh.without_surface;
    if (count == 0) return {};
    return fmt::format("{} of points or lines, which have no surface: only boxes contain {}, not shapes and triangles",
                       count == 1 ? "1 primitive is" : fmt::format("{} primitives are", count),
                       count == 1 ? "it" : "them");
}

std::string GltfModel::warning_of_steps() const {
    double step = 0;
    for (const Instance& instance : instances())
        step = std::max(step, instance.pose.largest_scale() * mesh(instance).step);
    if (!(step > 0)) return {};
    return fmt::format(
        "has coordinates that are integers, in steps of up to {:.2g}; parts that touched may overlap by as much "
        "(--tolerance {:.2g})",
        step, step);
}

}  // namespace

}  // namespace octopair::io::gltf

namespace octopair::io {

namespace {

using gltf::GltfFile;
using gltf::GltfModel;
using gltf::Instance;

/// Checks that octopair can read what the file requires. Returns whether Assimp must read the file.
bool is_for_assimp(const GltfFile& file) {
    if (!file.version().starts_with('1') && !file.version().starts_with('2'))
        refuse(file.path(), fmt::format("is of glTF {}; octopair reads glTF 2 and 1.0", shown_text(file.version())));
    if (file.version().starts_with('1')) return true;
    gltf::check_required_extensions(file);
    return gltf::needs_assimp(file);
}

/// Returns the objects of a model. Moves its meshes and names; the labels stay in its tree.
PlacedMeshes placed_meshes(GltfModel& model) {
    PlacedMeshes placed{"node", {}, {}, "m"};
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
    scene.largest_rounded = UnitChange(placed.unit, content.unit)(largest);
    scene.warnings = std::move(warnings);
    scene.space.up = UpAxis::y;
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
