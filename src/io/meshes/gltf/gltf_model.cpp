#include "io/meshes/gltf/gltf_model.hpp"

#include <algorithm>
#include <utility>

#include <fmt/format.h>

#include "io/files/failure.hpp"
#include "io/meshes/gltf/extensions.hpp"
#include "io/meshes/gltf/fields.hpp"

namespace octopair::io::gltf {

namespace {

using nlohmann::json;

/// Returns the nodes that are instances, or above an instance.
std::vector<bool> nodes_of_instances(const NodeTree& tree) {
    std::vector<bool> found(tree.nodes().size());
    for (const Instance& instance : tree.instances()) {
        for (std::size_t node = instance.node; node != Node::no_parent && !found[node];
             node = tree.nodes()[node].parent)
            found[node] = true;
    }
    return found;
}

/// Returns for each element of the array "nodes" whether an animation moves it. Skips what is not as it should be, because animations
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

}  // namespace

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

// Floats were rounded to float32 in the file. Its transforms count as rounded, too, because exporters compute them in float32: so they
// count for all coordinates that they move. Integers in a node without a transform are exact. How finely a file places its integers
// is not part of this bound: the default tolerance would else be as large as parts are coarse, and hide that they overlap.
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
        if (std::exchange(last, instance.node) == instance.node) continue;  // a further copy of the node
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
        if (std::exchange(last, instance.node) == instance.node) continue;  // a further copy of the node
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

}  // namespace octopair::io::gltf
