// Checks AMF files, and writes them in a form that Assimp reads rightly (correct_amf()).
#include "io/meshes/assimp/content/mesh_content.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <optional>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "io/files/failure.hpp"
#include "io/meshes/text_words.hpp"
#include "io/meshes/xml/xml_tree.hpp"

namespace octopair::io {

namespace {

/// Returns the only number of an element's text.
double only_number(const XmlElement& element) {
    const NumberList list = numbers_of(element.text());
    if (!list.wrong.empty() || list.numbers.size() != 1) {
        element.refuse(fmt::format("<{}> is '{}', which is no number; decimals are written with a point",
                                   element.name(), shown(element.text())));
    }
    return list.numbers[0];
}

double number_in(const XmlElement& parent, std::string_view name) {
    const auto child = parent.child(name);
    if (!child) parent.refuse(fmt::format("has no <{}>", name));
    return only_number(*child);
}

class AmfWriter {
public:
    explicit AmfWriter(const XmlTree& tree) : tree_(tree) {}

    MeshContent write() {
        const XmlElement root = tree_.root();
        out_.open("amf");
        for (const XmlElement& child : root.children()) {
            if (child.name() == "object" || child.name() == "constellation") check_id(child);
        }
        for (const XmlElement& object : root.children("object")) write_object(object);
        for (const XmlElement& constellation : root.children("constellation")) write_constellation(constellation);
        out_.close();
        return {out_.take(), {}, left_out_.list(), unit_of(root)};
    }

private:
    /// Returns the unit of the file, empty if AMF does not know it. The default is millimetres.
    static std::string unit_of(const XmlElement& root) {
        const std::string_view unit = root.attribute("unit").value_or("millimeter");
        constexpr std::array<std::pair<std::string_view, const char*>, 7> units = {{{"millimeter", "mm"},
                                                                                    {"inch", "in"},
                                                                                    {"feet", "ft"},
                                                                                    {"foot", "ft"},
                                                                                    {"meter", "m"},
                                                                                    {"micron", "µm"},
                                                                                    {"micrometer", "µm"}}};
        const auto* const known =
            std::find_if(units.begin(), units.end(), [&](const auto& any) { return any.first == unit; });
        return known == units.end() ? "" : known->second;
    }

    /// Assimp joins objects by their ids. So if a file has several objects, each needs an id that no other object has.
    void check_id(const XmlElement& element) {
        const auto id = element.attribute("id");
        const auto [first, is_new] = ids_.try_emplace(std::string(id.value_or("")), element.line());
        if (is_new) return;
        element.refuse(
            id ? fmt::format("the id '{}' is that of line {}, too; give each object an id", shown(*id), first->second)
               : fmt::format("has no id, as in line {}; give each object an id", first->second));
    }

    void write_object(const XmlElement& object) {
        out_.open("object");
        if (const auto id = object.attribute("id")) out_.attribute("id", *id);
        const std::vector<XmlElement> meshes = object.children("mesh");
        std::vector<std::size_t> first_vertices;
        std::size_t vertices = 0;
        out_.open("mesh");
        out_.open("vertices");
        for (const XmlElement& mesh : meshes) {
            first_vertices.push_back(vertices);
            for (const XmlElement& list : mesh.children("vertices")) {
                for (const XmlElement& vertex : list.children("vertex")) write_vertex(vertex), ++vertices;
            }
        }
        first_vertices.push_back(vertices);
        out_.close();
        write_volume(meshes, first_vertices);
        out_.close();
        out_.close();
    }

    void write_vertex(const XmlElement& vertex) {
        const auto place = vertex.child("coordinates");
        if (!place) vertex.refuse("has no <coordinates>");
        out_.open("vertex");
        out_.open("coordinates");
        for (const std::string_view axis : {"x", "y", "z"}) write_number(axis, number_in(*place, axis));
        out_.close();
        out_.close();
        if (vertex.child("normal")) left_out_.add("normals, which curve triangles");
    }

    void write_number(std::string_view name, double number) {
        out_.open(name);
        out_.text(fmt::format("{}", number));
        out_.close();
    }

    /// Writes the triangles of all volumes as one. `first_vertices`: number of the first vertex of each mesh, then the number of vertices.
    void write_volume(const std::vector<XmlElement>& meshes, const std::vector<std::size_t>& first_vertices) {
        bool open = false;
        for (std::size_t i = 0; i < meshes.size(); ++i) {
            for (const XmlElement& volume : meshes[i].children("volume")) {
                for (const XmlElement& triangle : volume.children("triangle")) {
                    if (!open) out_.open("volume");
                    open = true;
                    write_triangle(triangle, first_vertices[i], first_vertices[i + 1]);
                }
            }
            if (meshes[i].contains("edge")) left_out_.add("edges, which curve triangles");
        }
        if (open) out_.close();
    }

    void write_triangle(const XmlElement& triangle, std::size_t first, std::size_t end) {
        out_.open("triangle");
        for (const std::string_view corner : {"v1", "v2", "v3"}) {
            const double index = number_in(triangle, corner);
            if (!(index >= 0 && index < double(end - first)) || index != std::floor(index)) {
                triangle.refuse(
                    fmt::format("<{}> is {}, but the object has {} vertices", corner, number_text(index), end - first));
            }
            write_number(corner, index + double(first));
        }
        out_.close();
    }

    void write_constellation(const XmlElement& constellation) {
        out_.open("constellation");
        if (const auto id = constellation.attribute("id")) out_.attribute("id", *id);
        for (const XmlElement& instance : constellation.children("instance")) {
            out_.open("instance");
            for (const XmlElement& value : instance.children()) check_placement(value);
            const auto id = instance.attribute("objectid");
            if (!id || !ids_.contains(std::string(*id)))
                instance.refuse(fmt::format("the object '{}' is not in the file", shown(id.value_or(""))));
            out_.attribute("objectid", *id);
            for (const XmlElement& value : instance.children()) write_placement(value);
            out_.close();
        }
        out_.close();
    }

    void write_placement(const XmlElement& value) {
        const std::string_view name = value.name();
        if (name == "deltax" || name == "deltay" || name == "deltaz") write_number(name, only_number(value));
    }

    /// Refuses scales and mirrors of an instance: they are not part of AMF, but slicers write them.
    static void check_placement(const XmlElement& value) {
        const std::string_view name = value.name();
        const bool scale = name.starts_with("scale"), mirror = name.starts_with("mirror");
        if ((scale || mirror) && only_number(value) != (scale ? 1 : 0)) {
            value.refuse(
                fmt::format("an instance is {} (<{}>), which Assimp does not read; export it as STL, OBJ or 3MF",
                            scale ? "scaled" : "mirrored", name));
        }
        if ((name == "rx" || name == "ry" || name == "rz") && only_number(value) != 0) {
            value.refuse(fmt::format(
                "an instance is rotated (<{}>), which Assimp reads wrongly; export it as STL, OBJ or 3MF", name));
        }
    }

    const XmlTree& tree_;
    XmlWriter out_;
    LeftOut left_out_;
    std::map<std::string, std::size_t> ids_;  // id of an object or constellation -> its line
};

}  // namespace

MeshContent correct_amf(const std::string& path, std::string_view bytes) {
    const XmlTree tree(path, bytes);
    if (tree.root().name() != "amf") refuse(path, "has no element <amf>, which AMF files have");
    return AmfWriter(tree).write();
}

}  // namespace octopair::io
