// Checks COLLADA files, and writes them in a form that Assimp reads rightly (correct_collada()).
#include "io/meshes/assimp/content/mesh_content.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <optional>
#include <tuple>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "io/files/failure.hpp"
#include "io/meshes/assimp/content/xml_geometry.hpp"
#include "io/meshes/text_words.hpp"
#include "io/meshes/xml/xml_tree.hpp"

namespace octopair::io {

namespace {

using namespace std::string_view_literals;
using Vector = std::array<double, 3>;

template <std::size_t size>
bool is_one_of(std::string_view name, const std::array<std::string_view, size>& names) {
    return std::find(names.begin(), names.end(), name) != names.end();
}

constexpr std::array transform_names = {"lookat"sv, "matrix"sv, "rotate"sv, "scale"sv, "skew"sv, "translate"sv};

Vector cross(const Vector& a, const Vector& b) {
    return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}

/// Returns a vector of length 1.
/// Throws: Error{bad_input} if the vector has no direction.
Vector direction_of(const XmlElement& element, const Vector& vector) {
    const double length = std::hypot(vector[0], vector[1], vector[2]);
    if (!(length > 0) || !std::isfinite(length))
        element.refuse(fmt::format("<{}> has an axis without a direction", element.name()));
    return {vector[0] / length, vector[1] / length, vector[2] / length};
}

/// Returns the matrix of a <lookat>. Its numbers are the position of an eye, the point that the eye looks at, and the direction that is up.
std::vector<double> lookat_matrix(const XmlElement& element) {
    const std::vector<double> n = collada_numbers(element, 9);
    const Vector back = direction_of(element, {n[0] - n[3], n[1] - n[4], n[2] - n[5]});
    const Vector right = direction_of(element, cross({n[6], n[7], n[8]}, back)), up = cross(back, right);
    std::vector<double> matrix;
    for (std::size_t row = 0; row < 3; ++row) matrix.insert(matrix.end(), {right[row], up[row], back[row], n[row]});
    matrix.insert(matrix.end(), {0, 0, 0, 1});
    return matrix;
}

/// Returns an axis of length 1, and an angle.
std::vector<double> rotation_of(const XmlElement& element) {
    std::vector<double> n = collada_numbers(element, 4);
    if (n[3] == 0) return {0, 0, 1, 0};
    const Vector axis = direction_of(element, {n[0], n[1], n[2]});
    return {axis[0], axis[1], axis[2], n[3]};
}

std::vector<double> matrix_of(const XmlElement& element) {
    std::vector<double> n = collada_numbers(element, 16);
    if (n[12] != 0 || n[13] != 0 || n[14] != 0 || n[15] != 1)
        element.refuse("<matrix> is no affine transform: its last row must be 0 0 0 1");
    return n;
}

void write_transform(const XmlElement& element, XmlWriter& out) {
    const std::string_view name = element.name();
    if (name == "skew") {
        if (collada_numbers(element, 7)[0] != 0)
            element.refuse("<skew> is not read; export the node with a <matrix>, or its vertices in their places");
        return;
    }
    out.open(name == "lookat" ? "matrix" : name);
    if (const auto sid = element.attribute("sid")) out.attribute("sid", *sid);
    out.text(list_text(name == "lookat"   ? lookat_matrix(element)
                       : name == "rotate" ? rotation_of(element)
                       : name == "matrix" ? matrix_of(element)
                                          : collada_numbers(element, 3)));
    out.close();
}

/// Returns the materials that an instance binds, as one text. Instances with equal texts share a copy of their geometry.
std::string binding_of(const XmlElement& instance) {
    std::string key;
    for (const XmlElement& binding : instance.children("bind_material")) {
        const auto common = binding.child("technique_common");
        if (!common) continue;
        for (const XmlElement& material : common->children("instance_material")) {
            key += fmt::format("{}={};", material.attribute("symbol").value_or(""),
                               material.attribute("target").value_or(""));
        }
    }
    return key;
}

std::string_view trim(std::string_view text) {
    constexpr std::string_view white = " \t\r\n";
    const std::size_t begin = text.find_first_not_of(white);
    if (begin == std::string_view::npos) return {};
    return text.substr(begin, text.find_last_not_of(white) - begin + 1);
}

class ColladaWriter {
public:
    explicit ColladaWriter(const XmlTree& tree) : tree_(tree) {
        for (std::size_t i = 0; i < tree.size(); ++i) {
            const XmlElement element = tree.at(i);
            const auto id = element.attribute("id"), name = element.attribute("name");
            if (element.name() == "node" && name) named_nodes_.try_emplace(std::string(*name), i);
            if (!id) continue;
            if (element.name() == "geometry" && !geometries_.try_emplace(std::string(*id), i).second)
                element.refuse(fmt::format("a second geometry has the id '{}'", shown(*id)));
            if (element.name() == "controller") controllers_.try_emplace(std::string(*id), i);
            if (element.name() == "node" || element.name() == "visual_scene") nodes_.try_emplace(std::string(*id), i);
        }
    }

    MeshContent write() {
        const XmlElement root = tree_.root();
        out_.open(root.name());
        if (const auto version = root.attribute("version")) out_.attribute("version", *version);
        write_asset();
        constexpr std::array dropped = {
            "asset"sv,          "extra"sv,           "library_geometries"sv,    "library_nodes"sv,
            "library_lights"sv, "library_cameras"sv, "library_visual_scenes"sv, "scene"sv};
        const std::string scene = scene_text();  // before the geometries: it counts the copies of each geometry
        for (const XmlElement& child : root.children()) {
            if (!is_one_of(child.name(), dropped)) copy(child);
        }
        write_geometries();
        MeshContent content;
        content.text = out_.take() + scene + "</" + std::string(root.name()) + ">\n";
        content.left_out = left_out_.list();
        return content;
    }

private:
    /// Copies an element with its children, but leaves out <extra>, which has the data of programs.
    void copy(const XmlElement& element) {
        out_.open(element.name());
        for (const auto& [name, value] : element.attributes()) out_.attribute(name, value);
        out_.text(element.text());
        for (const XmlElement& child : element.children()) {
            if (child.name() != "extra") copy(child);
        }
        out_.close();
    }

    void write_asset() {
        const auto asset = tree_.root().child("asset");
        double meter = 1;
        std::string_view up = "Y_UP";
        if (asset) std::tie(meter, up) = unit_of(*asset, meter, up);
        for (std::size_t i = 1; i < tree_.size(); ++i) {
            const XmlElement other = tree_.at(i);
            if (other.name() == "asset" && unit_of(other, meter, up) != std::pair(meter, up))
                other.refuse("a part of the model has another unit or up axis than the whole; export it with one");
        }
        out_.open("asset");
        out_.open("unit");
        out_.attribute("meter", fmt::format("{}", meter));
        out_.close();
        out_.open("up_axis");
        out_.text(up);
        out_.close();
        out_.close();
    }

    static std::pair<double, std::string_view> unit_of(const XmlElement& asset, double meter, std::string_view up) {
        if (const auto unit = asset.child("unit")) {
            const std::string_view text = trim(unit->attribute("meter").value_or("1"));
            const NumberList list = numbers_with_commas_of(text);
            if (list.numbers.size() != 1 || !(list.numbers[0] > 0) || !std::isfinite(list.numbers[0]))
                unit->refuse(fmt::format("meter=\"{}\" is no length", shown(text)));
            meter = list.numbers[0];
        }
        if (const auto axis = asset.child("up_axis")) {
            up = trim(axis->text());
            if (up != "X_UP" && up != "Y_UP" && up != "Z_UP")
                axis->refuse(fmt::format("the up axis is '{}', not X_UP, Y_UP or Z_UP", shown(up)));
        }
        return {meter, up};
    }

    /// Returns the scene that the file instantiates, as XML.
    std::string scene_text() {
        const auto scene = tree_.root().child("scene");
        const auto instance = scene ? scene->child("instance_visual_scene") : std::nullopt;
        if (!instance) refuse(tree_.path(), "has no scene (<instance_visual_scene>)");
        const auto found = nodes_.find(reference(*instance));
        if (found == nodes_.end()) instance->refuse("the scene is not in the file");
        const XmlElement visual = tree_.at(found->second);
        std::swap(out_, scene_);
        out_.open("library_visual_scenes");
        write_node(visual);
        out_.close();
        out_.open("scene");
        out_.open("instance_visual_scene");
        out_.attribute("url", instance->attribute("url").value_or(""));
        out_.close();
        out_.close();
        std::string text = out_.take();
        std::swap(out_, scene_);
        return text;
    }

    /// Returns the id of a reference within the file, such as "#id"; empty for a reference to another file.
    static std::string reference(const XmlElement& element) {
        const std::string_view url = element.attribute("url").value_or("");
        return std::string(url.starts_with('#') ? url.substr(1) : std::string_view());
    }

    void write_node(const XmlElement& node) {
        if (std::find(open_.begin(), open_.end(), node.index()) != open_.end())
            node.refuse("the node has an instance of itself");
        if (out_.size() > max_bytes) node.refuse("the instances of nodes are more than 2 GiB");
        open_.push_back(node.index());
        out_.open(node.name());
        for (const auto& [name, value] : node.attributes()) out_.attribute(name, value);
        for (const XmlElement& child : node.children()) {
            if (is_one_of(child.name(), transform_names)) write_transform(child, out_);
            if (child.name() == "node") write_node(child);
            if (child.name() == "instance_geometry" || child.name() == "instance_controller") write_instance(child);
        }
        for (const XmlElement& instance : node.children("instance_node")) write_instanced_node(instance);
        out_.close();
        open_.pop_back();
    }

    void write_instanced_node(const XmlElement& instance) {
        const std::string id = reference(instance);
        if (id.empty()) return left_out_.add("instances of nodes in other files");
        const auto found = nodes_.find(id);
        if (found != nodes_.end()) return write_node(tree_.at(found->second));
        // Some programs write a name in place of an id.
        const auto named = named_nodes_.find(id);
        if (named == named_nodes_.end()) return left_out_.add("instances of nodes that the file does not have");
        write_node(tree_.at(named->second));
    }

    void write_instance(const XmlElement& instance) {
        const std::string id = reference(instance);
        if (id.empty()) return left_out_.add("instances of geometry in other files");
        const auto geometry = geometries_.find(id);
        if (geometry == geometries_.end() && !controllers_.contains(id))
            return left_out_.add("instances of geometry that the file does not have");
        if (geometry == geometries_.end()) {
            left_out_.add("deformations of skins and morphs");
        } else if (const XmlElement element = tree_.at(geometry->second); !element.child("mesh")) {
            return left_out_.add(fmt::format("geometry of type {}", type_of(element)));
        }
        out_.open(instance.name());
        out_.attribute("url", fmt::format("#{}", id_for(instance, id)));
        for (const XmlElement& child : instance.children()) {
            if (child.name() == "bind_material") copy(child);
        }
        out_.close();
    }

    static std::string_view type_of(const XmlElement& geometry) {
        for (const XmlElement& child : geometry.children()) {
            if (child.name() != "asset" && child.name() != "extra") return child.name();
        }
        return "unknown";
    }

    /// Returns the id of the copy of a geometry for the materials of an instance. The first copy has the id of the geometry.
    std::string id_for(const XmlElement& instance, const std::string& id) {
        const auto geometry = geometries_.find(id);
        if (geometry == geometries_.end()) return id;
        auto& bindings = bindings_[id];
        const bool many = count_primitive_groups(*tree_.at(geometry->second).child("mesh")) > 1;
        const std::string binding = many ? binding_of(instance) : "";
        auto at = std::find(bindings.begin(), bindings.end(), binding);
        if (at == bindings.end()) at = bindings.insert(at, binding);
        return copy_id(id, std::size_t(at - bindings.begin()));
    }

    static std::string copy_id(const std::string& id, std::size_t copy) {
        return copy == 0 ? id : fmt::format("{}.octopair-{}", id, copy);
    }

    void write_geometries() {
        out_.open("library_geometries");
        for (const auto& [id, index] : geometries_) {
            const XmlElement geometry = tree_.at(index);
            const auto mesh = geometry.child("mesh");
            const auto bindings = bindings_.find(id);
            if (!mesh || (bindings == bindings_.end() && controllers_.empty())) continue;
            const std::size_t copies =
                bindings == bindings_.end() ? 1 : std::max<std::size_t>(1, bindings->second.size());
            for (std::size_t copy = 0; copy < copies; ++copy) {
                out_.open("geometry");
                out_.attribute("id", copy_id(id, copy));
                if (const auto name = geometry.attribute("name")) out_.attribute("name", *name);
                write_collada_mesh(*mesh, out_);
                out_.close();
            }
        }
        out_.close();
    }

    static constexpr std::size_t max_bytes = std::size_t(1) << 31;

    const XmlTree& tree_;
    XmlWriter out_, scene_;
    LeftOut left_out_;
    std::map<std::string, std::size_t> geometries_, controllers_, nodes_;  // id -> element
    std::map<std::string, std::size_t> named_nodes_;                       // name -> first node
    std::map<std::string, std::vector<std::string>> bindings_;  // id of a geometry -> materials of its instances
    std::vector<std::size_t> open_;                             // nodes that are being written
};

}  // namespace

MeshContent correct_collada(const std::string& path, std::string_view bytes) {
    const XmlTree tree(path, bytes);
    if (tree.root().name() != "COLLADA") refuse(path, "has no element <COLLADA>, which COLLADA files have");
    return ColladaWriter(tree).write();
}

}  // namespace octopair::io
