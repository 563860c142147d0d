#include "io/meshes/gltf/node_tree.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <unordered_map>
#include <utility>

#include <fmt/format.h>

#include "io/files/failure.hpp"
#include "io/json/json_fields.hpp"
#include "io/meshes/gltf/accessor.hpp"
#include "io/meshes/gltf/fields.hpp"
#include "io/meshes/gltf/gltf_file.hpp"
#include "octopair/pose.hpp"

namespace octopair::io::gltf {

namespace {

using nlohmann::json;

constexpr std::string_view added_root = "ROOT";

/// A translation, a rotation as a quaternion x, y, z, w, and a scale: the form that glTF gives to transforms.
struct Placement {
    Point3d translation = {0, 0, 0};
    std::array<double, 4> rotation = {0, 0, 0, 1};
    Point3d scale = {1, 1, 1};
};

/// Returns the upper rows of a matrix. Its numbers are column by column.
Pose matrix_of(const JsonFields& node) {
    const auto numbers = numbers_or<16>(node, "matrix", {});
    constexpr std::array<double, 4> last_row = {0, 0, 0, 1};
    constexpr double rounding = 1e-5;  // exporters that compute in float32 make errors of this size
    Pose pose;
    for (std::size_t column = 0; column < 4; ++column) {
        if (!(std::abs(numbers[4 * column + 3] - last_row[column]) <= rounding))
            node.refuse_key("matrix", "the last row is not 0, 0, 0, 1");
        for (std::size_t row = 0; row < 3; ++row) pose.rows[row][column] = numbers[4 * column + row];
    }
    return pose;
}

/// Returns the pose that scales, then rotates, then moves. `place`: for messages.
/// Throws: Error{bad_input} if a number is not finite or the quaternion has length 0.
Pose pose_of(const Placement& placement, const std::string& place) {
    const auto& [x, y, z, w] = placement.rotation;
    for (const auto& numbers : {placement.translation, placement.scale}) {
        for (const double number : numbers) {
            if (!std::isfinite(number)) refuse(place, "the transform has the number " + number_text(number));
        }
    }
    const double length = std::hypot(std::hypot(x, y), std::hypot(z, w));
    if (!(length > 0) || !std::isfinite(length)) refuse(place, "the rotation has the length " + number_text(length));
    Pose pose = make_pose(placement.translation, {w, x, y, z});
    for (auto& row : pose.rows) {
        for (std::size_t axis = 0; axis < 3; ++axis) row[axis] *= placement.scale[axis];
    }
    return pose;
}

/// Returns the pose of a node: its matrix, or its translation, rotation and scale.
/// Throws: Error{bad_input} that names the key.
Pose node_pose(const JsonFields& node) {
    if (node.find("matrix") != nullptr) {
        for (const char* const key : {"translation", "rotation", "scale"}) {
            if (node.find(key) != nullptr)
                node.refuse_key(key, "the node has a matrix, too; only one of both is allowed");
        }
        return matrix_of(node);
    }
    Placement placement;
    placement.translation = numbers_or<3>(node, "translation", placement.translation);
    placement.rotation = numbers_or<4>(node, "rotation", placement.rotation);
    placement.scale = numbers_or<3>(node, "scale", placement.scale);
    return pose_of(placement, node.place());
}

double largest_of(const Pose& pose) {
    return std::max({std::abs(pose.rows[0][3]), std::abs(pose.rows[1][3]), std::abs(pose.rows[2][3])});
}

std::vector<std::uint64_t> numbers_in(const JsonFields& fields, std::string_view key) {
    std::vector<std::uint64_t> numbers;
    for (const json& value : array_or_empty(fields, key)) numbers.push_back(whole_number(value, fields.place_of(key)));
    return numbers;
}

/// Returns whether a node has the extension KHR_node_visibility with "visible": false.
bool is_hidden(const JsonFields& node) {
    const json* const extension = extension_of(node, visibility);
    if (extension == nullptr) return false;
    const JsonFields fields(*extension, fmt::format("{}: {}", node.place(), visibility));
    return fields.find("visible") != nullptr && !fields.boolean("visible");
}

/// Accessors with the transforms of the copies of a node. An accessor that the file does not have is not set.
struct Copies {
    std::optional<Accessor> translations, rotations, scales;
    std::optional<std::uint64_t> count;

    Placement placement(std::uint64_t i) const {
        Placement placement;
        if (translations) placement.translation = translations->at<3>(i);
        if (rotations) placement.rotation = rotations->at<4>(i);
        if (scales) placement.scale = scales->at<3>(i);
        return placement;
    }
};

Copies copies_in(GltfFile& file, const JsonFields& attributes, const json& object) {
    Copies copies;
    const auto set_count = [&](std::uint64_t count) {
        if (copies.count.value_or(count) != count) {
            refuse(attributes.place(),
                   fmt::format("has arrays of {} and {} elements, which must be equally many", *copies.count, count));
        }
        copies.count = count;
    };
    const auto read = [&](std::optional<Accessor>& to, std::string_view key, unsigned components) {
        if (attributes.find(key) == nullptr) return;
        to.emplace(file, whole_number(attributes, key), components);
        set_count(to->count());
    };
    read(copies.translations, "TRANSLATION", 3);
    read(copies.rotations, "ROTATION", 4);
    read(copies.scales, "SCALE", 3);
    if (copies.count) return copies;
    for (const auto& [key, value] :
         object.items()) {  // only attributes of applications: all copies are at the same place
        set_count(whole_number(file.item("accessors", whole_number(value, attributes.place_of(key))), "count"));
    }
    return copies;
}

}  // namespace

/// A node that waits to be visited.
struct NodeTree::Waiting {
    std::uint64_t number;
    std::size_t parent;    // index in nodes_
    std::size_t position;  // position among the children of the parent
    bool repeats;          // true if the node and a sibling take their names from meshes of equal names
};

NodeTree::NodeTree(GltfFile& file) : file_(file), visited_(file.count("nodes")) {
    const std::vector<std::uint64_t> roots = find_roots();
    roots_ = roots.size();
    std::vector<Waiting> stack;
    push(roots, Node::no_parent, stack);
    while (!stack.empty()) {
        const Waiting next = stack.back();
        stack.pop_back();
        if (nodes_.size() % 1024 == 0) file_.checkpoint();
        add(next, stack);
    }
}

std::vector<std::uint64_t> NodeTree::find_roots() {
    const std::size_t scenes = file_.count("scenes");
    if (scenes > 0) {
        const std::uint64_t number = whole_number_or(file_.fields(), "scene", 0);
        const JsonFields scene = file_.item("scenes", number);
        if (scenes > 1) {
            const std::string name = name_in(scene);
            note_ = fmt::format("has {} scenes; only scenes[{}]{} is read", scenes, number,
                                name.empty() ? "" : fmt::format(" '{}'", name));
        }
        return numbers_in(scene, "nodes");
    }
    std::vector<bool> is_child(visited_.size());
    for (std::size_t i = 0; i < visited_.size(); ++i) {
        if (i % 1024 == 0) file_.checkpoint();
        for (const std::uint64_t child : numbers_in(file_.item("nodes", i), "children")) {
            if (child < is_child.size()) is_child[child] = true;
        }
    }
    std::vector<std::uint64_t> roots;
    for (std::size_t i = 0; i < is_child.size(); ++i) {
        if (!is_child[i]) roots.push_back(i);
    }
    return roots;
}

/// Returns the name of the mesh of a node without a name; empty for other nodes.
std::string NodeTree::mesh_name(const JsonFields& node) const {
    const bool has_name = !name_in(node).empty() || node.find("mesh") == nullptr;
    return has_name ? std::string() : name_in(file_.item("meshes", whole_number(node, "mesh")));
}

void NodeTree::push(const std::vector<std::uint64_t>& siblings, std::size_t parent, std::vector<Waiting>& stack) const {
    std::vector<std::string> names;
    std::unordered_map<std::string_view, std::size_t> counts;
    names.reserve(siblings.size());
    for (const std::uint64_t number : siblings) {
        if (names.size() % 1024 == 0) file_.checkpoint();
        names.push_back(mesh_name(file_.item("nodes", number)));
        ++counts[names.back()];
    }
    for (std::size_t i = siblings.size(); i-- > 0;)
        stack.push_back({siblings[i], parent, i, !names[i].empty() && counts[names[i]] > 1});
}

void NodeTree::add(const Waiting& waiting, std::vector<Waiting>& stack) {
    const JsonFields fields = file_.item("nodes", waiting.number);
    if (visited_[waiting.number])
        refuse(fields.place(), "occurs twice in the scene: a node must have one parent at most");
    visited_[waiting.number] = true;
    const json* const mesh_value = fields.find("mesh");
    const std::uint64_t mesh = mesh_value == nullptr ? 0 : whole_number(fields, "mesh");
    std::string label = name_in(fields);
    if (label.empty()) label = mesh_name(fields);
    const std::string own = label.empty() || waiting.repeats ? fmt::format("{}#{}", label, waiting.position) : label;
    const Pose pose = node_pose(fields);
    Node node{.number = waiting.number,
              .parent = waiting.parent,
              .named_above = waiting.parent,
              .path = own,
              .label = std::move(label),
              .pose = BoundedPose(pose.rows),
              .translations = largest_of(pose),
              .has_skin = fields.find("skin") != nullptr,
              .is_hidden = is_hidden(fields)};
    if (waiting.parent != Node::no_parent) {
        const Node& parent = nodes_[waiting.parent];
        if (parent.label.empty()) node.named_above = parent.named_above;
        node.is_hidden |= parent.is_hidden;
        node.pose = parent.pose * node.pose;
        node.translations = parent.translations + parent.pose.largest_scale() * node.translations;
    }
    const std::string_view above = waiting.parent != Node::no_parent ? std::string_view(nodes_[waiting.parent].path)
                                                                     : (has_added_root() ? added_root : "");
    if (!above.empty()) {
        file_.charge(above.size() + own.size(), 2);  // the path of the node and the name of the object
        node.path = fmt::format("{}/{}", above, own);
    }
    nodes_.push_back(std::move(node));
    const std::size_t index = nodes_.size() - 1;
    push(numbers_in(fields, "children"), index, stack);
    if (mesh_value == nullptr) return;
    if (const json* const extension = extension_of(fields, instancing)) {
        add_copies(fields, index, mesh, *extension);
    } else {
        instances_.push_back({index, nodes_[index].path, nodes_[index].pose, nodes_[index].translations, mesh});
    }
}

void NodeTree::add_copies(const JsonFields& fields, std::size_t node, std::uint64_t mesh, const json& extension) {
    const std::string place = fmt::format("{}: {}", fields.place(), instancing);
    const JsonFields own(extension, place);
    const json& object = own.required("attributes");
    const Copies copies = copies_in(file_, JsonFields(object, own.place_of("attributes")), object);
    const Node& from = nodes_[node];
    const double scale = from.pose.largest_scale();
    const std::uint64_t count = copies.count.value_or(0);
    file_.charge(count, sizeof(Instance) + from.path.size() + sizeof("/#18446744073709551615"));
    for (std::uint64_t i = 0; i < count; ++i) {
        if (i % 1024 == 0) file_.checkpoint();
        const Pose pose = pose_of(copies.placement(i), fmt::format("{}: copy {}", place, i));
        instances_.push_back({node, fmt::format("{}/#{}", from.path, i), from.pose * BoundedPose(pose.rows),
                              from.translations + scale * largest_of(pose), mesh});
    }
}

std::string_view NodeTree::parent_label(std::size_t node) const {
    const std::size_t above = nodes_[node].named_above;
    if (above != Node::no_parent) return nodes_[above].label;
    return has_added_root() ? added_root : std::string_view();
}

}  // namespace octopair::io::gltf
