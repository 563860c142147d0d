#include "io/meshes/three_mf/three_mf_scene.hpp"

#include <algorithm>
#include <array>
#include <map>
#include <string>
#include <string_view>
#include <unordered_map>
#include <utility>
#include <vector>

#include "io/files/failure.hpp"
#include "io/json/json_fields.hpp"
#include "io/meshes/placed_meshes.hpp"
#include "io/meshes/three_mf/model.hpp"
#include "io/meshes/three_mf/package.hpp"
#include "octopair/error.hpp"

#include <fmt/format.h>

namespace octopair::io::three_mf {

namespace {

/// The objects of a build, and warnings for the user, each one line "FILE: ...".
struct Build {
    PlacedMeshes placed;
    std::vector<std::string> warnings;
    std::vector<std::string> not_read;  ///< LoadedScene::not_read
};

constexpr std::string_view build_root = "ROOT";
constexpr std::uint64_t most_nodes = std::uint64_t(1) << 24;

/// An item, or a component within it.
struct BuildNode {
    const Reference* reference;
    std::size_t part;    // part that has the reference
    std::size_t parent;  // index of the node above, plus 1; 0 for an item
    std::string name;    // path of the node's name
    std::string_view label, parent_label;
    BoundedPose pose;
};

std::string_view label_of(const ModelObject& object, const Reference& reference) {
    if (!object.name.empty()) return object.name;
    return reference.part_number.empty() ? std::string_view(object.part_number)
                                         : std::string_view(reference.part_number);
}

/// Lists the nodes of a build and makes objects of them.
class BuildMaker {
public:
    explicit BuildMaker(Model& model) : model_(model) { build_.placed.noun = "object"; }

    Build make() {
        check_count();
        std::vector<BuildNode> waiting;
        const bool has_root = model_.start().items.size() > 1;
        push(model_.start().items,
             {nullptr, 0, 0, std::string(has_root ? build_root : ""), {}, has_root ? build_root : "", {}}, waiting);
        for (std::size_t nodes = 1; !waiting.empty(); ++nodes) {
            if (nodes % 1024 == 0) model_.budget().checkpoint();
            BuildNode node = std::move(waiting.back());
            waiting.pop_back();
            const ModelObject& object = model_.object(node.reference->target);
            if (node.parent != 0 && object.type == ObjectType::other) {
                ++others_;  // slicers store modifiers and support blockers as such objects, which are not printed
            } else if (object.has_mesh) {
                add_object(std::move(node), object);
            } else {
                check_components(node, object);
                node.parent = nodes;
                push(object.components, node, waiting);
            }
        }
        warn();
        return std::move(build_);
    }

private:
    /// Throws: Error{resource_limit} if the build has too many nodes. A short file may describe exponentially many.
    void check_count() const {
        std::vector<std::vector<std::uint64_t>> counts(model_.parts().size());
        const auto count_of = [&](const Reference& reference) {
            return counts[reference.target.part][reference.target.number];
        };
        const auto total_of = [&](const std::vector<Reference>& references) {
            std::uint64_t total = 0;
            for (const Reference& reference : references) total = std::min(total + count_of(reference), most_nodes + 1);
            return total;
        };
        // The start part comes last: only its objects refer to other parts, and they need the counts of those parts.
        for (std::size_t part = model_.parts().size(); part-- > 0;) {
            for (const ModelObject& object : model_.parts()[part].objects)
                counts[part].push_back(1 + total_of(object.components));
        }
        if (total_of(model_.start().items) <= most_nodes) return;
        throw Error(ErrorCode::resource_limit,
                    fmt::format("{}: its build consists of more than {} components; build fewer items at once",
                                model_.path(), most_nodes));
    }

    /// Adds the nodes below a node to `waiting`, the first node last. `parent.parent` becomes the parent of the new nodes.
    void push(const std::vector<Reference>& references, const BuildNode& parent, std::vector<BuildNode>& waiting) {
        std::unordered_map<std::string_view, std::size_t> counts;
        for (const Reference& reference : references) ++counts[label_of(model_.object(reference.target), reference)];
        const std::size_t part = parent.reference == nullptr ? 0 : parent.reference->target.part;
        for (std::size_t i = references.size(); i-- > 0;) {
            const Reference& reference = references[i];
            const std::string_view label = label_of(model_.object(reference.target), reference);
            std::string name = parent.name.empty() ? std::string() : parent.name + '/';
            name += label;
            if (label.empty() || counts[label] > 1) name += fmt::format("#{}", i);
            model_.budget().charge(1, sizeof(BuildNode) + name.size());
            waiting.push_back({&reference, part, parent.parent, std::move(name), label,
                               parent.label.empty() ? parent.parent_label : parent.label,
                               parent.pose * BoundedPose(reference.pose.rows)});
        }
    }

    void add_object(BuildNode node, const ModelObject& object) {
        check_type(node, object);
        const auto [mesh, is_new] = meshes_.try_emplace(node.reference->target, build_.placed.meshes.size());
        if (is_new) build_.placed.meshes.push_back(model_.take_mesh(node.reference->target));
        supports_ += object.type == ObjectType::support || object.type == ObjectType::solidsupport;
        coarse_ += object.is_coarse;
        note_extension(object);
        if (build_.placed.meshes[mesh->second].empty()) return;
        model_.budget().charge(1, sizeof(PlacedMesh));
        build_.placed.objects.push_back({.name = std::move(node.name),
                                         .label = node.label,
                                         .parent_label = node.parent_label,
                                         .pose = node.pose,
                                         .mesh = mesh->second,
                                         .parent = node.parent});
    }

    void check_type(const BuildNode& node, const ModelObject& object) const {
        if (object.type == ObjectType::other) {
            refuse(model_.place_of(node.part, node.reference->line),
                   fmt::format("the build has object {} of the type 'other', which 3MF does not allow; remove it "
                               "from the build, or give it the type 'model'",
                               object.id));
        }
        if (object.is_coarse && model_.parts()[node.reference->target.part].needs_slices) {
            refuse(model_.place_of(node.part, node.reference->line),
                   fmt::format("the mesh of object {} is coarse, and its shape is in slices, which octopair does not "
                               "read; write the file with full meshes",
                               object.id));
        }
    }

    /// Throws: Error{bad_input} if an object has neither a mesh nor components.
    void check_components(const BuildNode& node, const ModelObject& object) {
        note_extension(object);
        if (object.has_components || !object.extension.empty()) return;
        refuse(model_.place_of(node.part, node.reference->line),
               fmt::format("refers to object {}, which has neither a mesh nor components; remove the reference",
                           object.id));
    }

    void note_extension(const ModelObject& object) {
        if (object.extension.empty()) return;
        if (extended_++ == 0) first_extension_ = object.extension;
    }

    void warn() {
        const auto add = [&](std::uint64_t count, std::string_view what) {
            if (count == 0) return;
            build_.warnings.push_back(
                fmt::format("{}: {} {} {}", model_.path(), count, count == 1 ? "object" : "objects", what));
        };
        add(supports_, "of the types support or solidsupport: read like the others");
        add(others_, "of the type other within other objects: left out, because they are not printed");
        add(coarse_, "with a mesh that stands for a finer shape, which is not read");
        add(extended_,
            fmt::format("with an extension that may change the shape and is not read, such as {}", first_extension_));
        if (others_ > 0) build_.not_read.push_back(fmt::format("parts of the type other ({})", others_));
        if (coarse_ > 0) build_.not_read.push_back(fmt::format("finer shapes ({})", coarse_));
        if (extended_ > 0) build_.not_read.push_back(fmt::format("extensions of objects ({})", extended_));
    }

    Model& model_;
    Build build_;
    std::map<ObjectPlace, std::size_t> meshes_;  // object -> index in PlacedMeshes::meshes
    std::uint64_t supports_ = 0, others_ = 0, coarse_ = 0, extended_ = 0;
    std::string first_extension_;
};

/// Moves the meshes out of the model. The labels stay in the model.
/// Throws: Error{bad_input} that names the part and the line, if the build has an object of type other, or one without a shape;
/// Error{resource_limit} for more than 2^24 objects; Error{cancelled}.
Build make_build(Model& model) { return BuildMaker(model).make(); }

}  // namespace

}  // namespace octopair::io::three_mf

namespace octopair::io {

namespace {

using three_mf::Build;
using three_mf::Model;
using three_mf::Package;

/// Returns the short form of a unit of 3MF. Requires: the unit is one of 3MF.
std::string short_unit(std::string_view unit) {
    constexpr std::array<std::pair<std::string_view, const char*>, 6> units = {
        {{"micron", "µm"}, {"millimeter", "mm"}, {"centimeter", "cm"}, {"inch", "in"}, {"foot", "ft"}, {"meter", "m"}}};
    return std::find_if(units.begin(), units.end(), [&](const auto& known) { return known.first == unit; })->second;
}

std::vector<std::string> warnings_of(const Model& model, const Build& build) {
    std::vector<std::string> warnings = model.warnings();
    warnings.insert(warnings.end(), build.warnings.begin(), build.warnings.end());
    return warnings;
}

LoadedScene scene_of_package(Package& package, const SceneContent& content) {
    Model model(package, content.progress);
    Build build = three_mf::make_build(model);
    build.placed.unit = short_unit(model.start().unit);
    LoadedScene scene = scene_of(build.placed, content, package.budget());
    scene.warnings = warnings_of(model, build);
    scene.not_read = std::move(build.not_read);
    scene.space.up = UpAxis::z;
    return scene;
}

}  // namespace

bool is_three_mf_ending(std::string_view ending) { return ending == ".3mf"; }

LoadedScene read_three_mf_scene(const std::string& path, const SceneContent& content, const std::stop_token& stop) {
    Package package(path, stop);
    return scene_of_package(package, content);
}

LoadedScene parse_three_mf_scene(const std::string& path, Buffer<std::byte> bytes, const SceneContent& content,
                                 const std::stop_token& stop) {
    Package package(path, std::move(bytes), stop);
    return scene_of_package(package, content);
}

shape::Mesh read_three_mf_mesh(const std::string& path, LoadedScene& scene, const std::stop_token& stop) {
    Package package(path, stop);
    Model model(package, {});
    const Build build = three_mf::make_build(model);
    for (std::string& warning : warnings_of(model, build)) scene.warnings.push_back(std::move(warning));
    return whole_mesh_of(build.placed, package.budget());
}

std::string three_mf_version(const std::string& path) {
    Package package(path, {});
    const std::string start = package.find_start();
    const auto text = package.text_of(start, "the package");
    const std::string version = three_mf::parse_version(start, text, package.budget());
    return version.empty() ? "" : "core " + version;
}

}  // namespace octopair::io
