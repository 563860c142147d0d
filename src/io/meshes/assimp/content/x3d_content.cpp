// Checks X3D files, and writes them in a form that Assimp reads rightly (correct_x3d()).
#include "io/meshes/assimp/content/mesh_content.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <map>
#include <optional>
#include <vector>

#include <fmt/format.h>

#include "base/memory.hpp"
#include "io/files/failure.hpp"
#include "io/files/input_file.hpp"
#include "io/formats/unit_change.hpp"
#include "io/meshes/assimp/content/xml_geometry.hpp"
#include "io/meshes/text_words.hpp"
#include "io/meshes/xml/xml_tree.hpp"

namespace octopair::io {

namespace {

using namespace std::string_view_literals;

/// Names of groups, each with the name under which the group is written.
constexpr auto groups = std::to_array<std::pair<std::string_view, std::string_view>>({
    {"Anchor", "Group"},
    {"CADAssembly", "Group"},
    {"CADFace", "Group"},
    {"CADLayer", "Group"},
    {"CADPart", "Transform"},
    {"Collision", "Group"},
    {"Group", "Group"},
    {"StaticGroup", "Group"},
    {"Switch", "Group"},
    {"Transform", "Transform"},
    {"ViewpointGroup", "Group"},
});

std::string_view group_name(std::string_view name) {
    const auto found =
        std::find_if(groups.begin(), groups.end(), [&](const auto& group) { return group.first == name; });
    return found == groups.end() ? std::string_view() : found->second;
}

bool is_metadata(const XmlElement& node) { return node.name().starts_with("Metadata") || node.name() == "IS"; }

/// Writes the scene of one file, and the scenes of the files that its Inline nodes name.
class X3dWriter {
public:
    X3dWriter(const XmlTree& tree, XmlWriter& out, LeftOut& left_out) : tree_(tree), out_(out), left_out_(left_out) {
        for (std::size_t i = 0; i < tree.size(); ++i) {
            if (const auto name = tree.at(i).attribute("DEF")) definitions_[std::string(*name)].push_back(i);
        }
    }

    void write_scene(std::size_t files) {
        files_ = files;
        for (std::size_t i = 0; i < tree_.size(); ++i) {
            if (tree_.at(i).name() != "X3D") continue;
            for (const XmlElement& head : tree_.at(i).children("head")) check_units(head);
            for (const XmlElement& scene : tree_.at(i).children("Scene")) write_children(scene);
            return;
        }
        refuse(tree_.path(), "has no element <X3D>, which X3D files have");
    }

    /// Returns the unit of lengths, empty for one that is not known; nothing if the file states none.
    const std::optional<std::string>& unit() const { return unit_; }

private:
    /// Reads the units of angles and lengths. Assimp ignores them, and reads angles as radians.
    void check_units(const XmlElement& head) {
        for (const XmlElement& unit : head.children("unit")) {
            const std::vector<double> factor = x3d_numbers(unit, "conversionFactor");
            if (factor.size() != 1 || !(factor[0] > 0)) unit.refuse("conversionFactor is no number above 0");
            const std::string_view category = unit.attribute("category").value_or("");
            if (category == "angle") radians_ = factor[0];
            if (category == "length") unit_ = unit_of_metres(factor[0]);
            if (category == "length" && factor[0] != 1)
                left_out_.add("the unit of lengths, which are read as they are");
        }
    }

    /// Returns the node that `node` refers to by USE: the last element before `node` that defines this name (DEF).
    XmlElement used_by(const XmlElement& node) const {
        const auto name = node.attribute("USE");
        if (!name || name->empty()) return node;
        const auto found = definitions_.find(std::string(*name));
        std::optional<std::size_t> last;
        if (found != definitions_.end()) {
            for (const std::size_t index : found->second) {
                if (index < node.index()) last = index;
            }
        }
        if (!last) node.refuse(fmt::format("USE=\"{}\": no node before it has this name as DEF", shown(*name)));
        return tree_.at(*last);
    }

    void write_children(const XmlElement& parent) {
        for (const XmlElement& child : parent.children()) {
            const auto field = child.attribute("containerField");
            if (!field || *field != "proxy") write_node(child);
        }
    }

    void write_node(const XmlElement& user) {
        const XmlElement node = used_by(user);
        if (std::find(open_.begin(), open_.end(), node.index()) != open_.end())
            user.refuse(fmt::format("<{}> uses a node that contains it", user.name()));
        if (out_.size() > max_bytes) user.refuse("the nodes that USE repeats are more than 2 GiB");
        open_.push_back(node.index());
        if (const std::string_view written = group_name(node.name()); !written.empty()) {
            write_group(node, written);
        } else if (node.name() == "Shape") {
            write_shape(node);
        } else if (node.name() == "Inline") {
            write_inline(node);
        } else if (node.name() == "ProtoInstance" || (node.contains("Shape") && !node.name().ends_with("Declare"))) {
            left_out_.add(fmt::format("nodes of type {}", node.name()));
        }
        open_.pop_back();
    }

    void write_group(const XmlElement& node, std::string_view written) {
        begin_group(node, written);
        if (written == "Transform") write_transform(node);
        const std::size_t before = out_.size();
        if (node.name() == "Switch") {
            write_choice(node);
        } else {
            write_children(node);
        }
        end_group(before);
    }

    void begin_group(const XmlElement& node, std::string_view written) {
        out_.open(written);
        if (const auto name = node.attribute("DEF")) out_.attribute("DEF", *name);
    }

    /// Ends a group. Assimp leaves an empty group twice, so a group without children gets a child without geometry.
    void end_group(std::size_t size_before) {
        if (out_.size() == size_before) {
            out_.open("Viewpoint");
            out_.close();
        }
        out_.close();
    }

    void write_transform(const XmlElement& node) {
        for (const std::string_view name : {"center"sv, "scale"sv, "translation"sv})
            write_x3d_numbers(node, name, 3, out_);
        for (const std::string_view name : {"rotation"sv, "scaleOrientation"sv}) {
            if (node.attribute(name)) out_.attribute(name, list_text(rotation_of(node, name)));
        }
    }

    /// Returns an axis of length 1, and an angle.
    std::vector<double> rotation_of(const XmlElement& node, std::string_view name) const {
        std::vector<double> rotation = x3d_numbers(node, name);
        if (rotation.size() != 4) node.refuse(fmt::format("{} has {} numbers in place of 4", name, rotation.size()));
        const double length = std::hypot(rotation[0], rotation[1], rotation[2]);
        if (rotation[3] == 0) return {0, 0, 1, 0};
        if (!(length > 0) || !std::isfinite(length)) node.refuse(fmt::format("{} has no axis", name));
        for (std::size_t axis = 0; axis < 3; ++axis) rotation[axis] /= length;
        rotation[3] *= radians_;
        return rotation;
    }

    void write_choice(const XmlElement& node) {
        const std::vector<double> choice = x3d_numbers(node, "whichChoice");
        if (choice.empty() || choice[0] < 0) return;
        double position = 0;
        for (const XmlElement& child : node.children()) {
            if (is_metadata(child)) continue;
            if (position++ == choice[0]) write_node(child);
        }
    }

    void write_shape(const XmlElement& shape) {
        out_.open("Shape");
        for (const XmlElement& child : shape.children()) {
            if (is_metadata(child) || child.name() == "Appearance") continue;
            const XmlElement geometry = used_by(child);
            const auto resolve = [this](const XmlElement& user) { return used_by(user); };
            if (!write_x3d_geometry(geometry, resolve, out_))
                left_out_.add(fmt::format("geometry of type {}", geometry.name()));
        }
        out_.close();
    }

    /// Writes the scene of another file as a group within a group, as Assimp does.
    void write_inline(const XmlElement& node) {
        const auto load = node.attribute("load");
        begin_group(node, "Group");
        const std::size_t before = out_.size();
        if (!load || !(load->starts_with('f') || load->starts_with('F'))) {
            const std::string path = file_of(node);
            if (files_ == 0) node.refuse("the files that Inline nodes name are nested more than 16 times");
            const InputFile file(path);
            Buffer<char> bytes{std::size_t(file.size())};
            file.read(0, std::as_writable_bytes(bytes.span()));
            const XmlTree tree(path, {bytes.data(), bytes.size()});
            out_.open("Group");
            const std::size_t inner = out_.size();
            X3dWriter(tree, out_, left_out_).write_scene(files_ - 1);
            end_group(inner);
        }
        end_group(before);
    }

    /// Returns the first file that an Inline node names and that exists.
    std::string file_of(const XmlElement& node) const {
        namespace fs = std::filesystem;
        std::string_view urls = node.attribute("url").value_or("");
        for (auto url = take_list_word(urls, ",\"'"); !url.empty(); url = take_list_word(urls, ",\"'")) {
            std::string path = (fs::path(tree_.path()).parent_path() / std::string(url)).string();
            std::error_code ignored;
            if (fs::is_regular_file(path, ignored)) return path;
        }
        node.refuse(fmt::format("no file that the Inline node names is there ({}); put the file beside this one",
                                shown(node.attribute("url").value_or(""))));
    }

    static constexpr std::size_t max_bytes = std::size_t(1) << 31;

    const XmlTree& tree_;
    XmlWriter& out_;
    LeftOut& left_out_;
    double radians_ = 1;  // radians in the file's unit of angles
    std::optional<std::string> unit_;
    std::map<std::string, std::vector<std::size_t>> definitions_;
    std::vector<std::size_t> open_;  // nodes that are being written
    std::size_t files_ = 0;          // number of levels of Inline nodes that this file may still have
};

}  // namespace

MeshContent correct_x3d(const std::string& path, std::string_view bytes) {
    const XmlTree tree(path, bytes);
    XmlWriter out;
    LeftOut left_out;
    out.open("X3D");
    out.open("Scene");
    X3dWriter writer(tree, out, left_out);
    writer.write_scene(16);
    out.close();
    out.close();
    return {out.take(), {}, left_out.list(), writer.unit()};
}

}  // namespace octopair::io
