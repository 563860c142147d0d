#include "io/meshes/assimp/scene_parts.hpp"

#include <cmath>
#include <limits>
#include <map>
#include <optional>
#include <set>
#include <string>

#include <assimp/material.h>
#include <fmt/format.h>

#include "io/formats/format_choice.hpp"
#include "io/meshes/assimp/ifc_text.hpp"
#include "octopair/error.hpp"

namespace octopair::io {

namespace {

std::string& text_of(DetailTexts& texts, Detail detail) { return texts[std::size_t(detail)]; }

std::string_view name_of(const aiNode& node) { return {node.mName.C_Str(), node.mName.length}; }

/// Returns whether Assimp invented the name of a material, because the file gives none.
bool is_invented(std::string_view material) {
    return material.empty() || material == AI_DEFAULT_MATERIAL_NAME || material.starts_with("<IFCDefault");
}

std::set<std::string> materials_of(const MeshFile& file, const MeshInstance& instance) {
    std::set<std::string> names;
    for (const unsigned number : instance.meshes()) {
        const unsigned material = file.mesh(number).mMaterialIndex;
        if (material >= file.scene().mNumMaterials) continue;
        const std::string name = file.scene().mMaterials[material]->GetName().C_Str();
        if (!is_invented(name)) names.insert(name);
    }
    return names;
}

/// An element of an IFC model, and its node.
struct ElementNode {
    IfcElement element;
    const aiNode* node;
};

/// Returns the nearest element at or above `node` for which `accept` is true.
template <typename Accept>
std::optional<ElementNode> nearest_element(const aiNode* node, const Accept& accept) {
    for (; node != nullptr; node = node->mParent) {
        const auto element = parse_ifc_element(name_of(*node));
        if (element && accept(*element)) return ElementNode{*element, node};
    }
    return std::nullopt;
}

/// Returns the name of an element, or its type if it has none.
std::string label_of(const IfcElement& element, const IfcTexts& names) {
    const auto known = names.find(std::string(element.id));
    if (known != names.end()) return known->second;
    return std::string(element.name.empty() ? element.type : element.name);
}

void add_ifc_details(const aiNode& node, const IfcText& text, DetailTexts& texts) {
    const IfcTexts& names = text.names;
    const auto any = [](const IfcElement&) { return true; };
    const auto own = nearest_element(&node, any);
    if (!own) return;
    text_of(texts, Detail::label) = label_of(own->element, names);
    text_of(texts, Detail::type) = own->element.type;
    text_of(texts, Detail::id) = own->element.id;
    const auto material = text.materials.find(std::string(own->element.id));
    if (material != text.materials.end()) text_of(texts, Detail::material) = material->second;
    if (const auto parent = nearest_element(own->node->mParent, any))
        text_of(texts, Detail::parent) = label_of(parent->element, names);
    const auto is_storey = [](const IfcElement& element) { return element.type == "IfcBuildingStorey"; };
    if (const auto storey = nearest_element(&node, is_storey))
        text_of(texts, Detail::level) = label_of(storey->element, names);
}

void add_node_details(const aiNode& node, DetailTexts& texts) {
    text_of(texts, Detail::label) = name_of(node);
    const aiNode* parent = node.mParent;
    while (parent != nullptr && parent->mName.length == 0) parent = parent->mParent;
    if (parent != nullptr) text_of(texts, Detail::parent) = name_of(*parent);
}

constexpr std::uint32_t none = std::numeric_limits<std::uint32_t>::max();

/// A mesh of a file, and its number in the file.
struct NumberedMesh {
    const MeshFile& file;
    unsigned number;
};

/// Appends the triangles of a mesh to `to`. `place(i)` returns the position of vertex i.
template <typename Place>
void append_mesh(const NumberedMesh& mesh, const Place& place, shape::Mesh& to) {
    std::vector<std::uint32_t> numbers(mesh.file.mesh(mesh.number).mNumVertices, none);
    mesh.file.for_each_triangle(mesh.number, [&](const std::array<unsigned, 3>& corners) {
        std::array<std::uint32_t, 3> triangle;
        for (unsigned k = 0; k < 3; ++k) {
            std::uint32_t& number = numbers[corners[k]];
            if (number == none) {
                if (to.vertices.size() == none)
                    throw Error(ErrorCode::resource_limit, "a mesh has more than 2^32 - 1 vertices");
                number = std::uint32_t(to.vertices.size());
                to.vertices.push_back(place(corners[k]));
            }
            triangle[k] = number;
        }
        to.triangles.push_back(triangle);
    });
}

shape::Mesh shape_of(const MeshFile& file, const MeshInstance& instance) {
    shape::Mesh shape;
    for (const unsigned number : instance.meshes()) {
        const aiMesh& mesh = file.mesh(number);
        append_mesh(
            {file, number}, [&](unsigned index) { return MeshFile::vertex(mesh, index); }, shape);
    }
    return shape;
}

}  // namespace

ObjectDetails details_of(const MeshFile& file) {
    ObjectDetails details;
    DetailsBuilder builder(details);
    const bool is_ifc = is_ifc_file(file.path());
    for (const MeshInstance& instance : file.instances()) {
        DetailTexts texts;
        if (is_ifc) {
            add_ifc_details(*instance.node, file.ifc_text(), texts);
        } else {
            add_node_details(*instance.node, texts);
        }
        std::string& material = text_of(texts, Detail::material);
        if (material.empty()) material = joined_materials(materials_of(file, instance));
        builder.add(texts);
    }
    return details;
}

ObjectRelations relations_of(const MeshFile& file) {
    ObjectRelations relations;
    const IfcText& text = file.ifc_text();
    if (text.bodies.empty()) return relations;
    const std::string scope = (text.project.empty() ? file.path() : text.project) + '/';
    KeyNumbers numbers(relations.keys);
    for (std::size_t i = 0; i < text.links.size(); ++i) {
        for (const auto& [from, to] : text.links[i])
            relations.links[i].push_back({numbers.of(scope + from), numbers.of(scope + to)});
    }
    for (const MeshInstance& instance : file.instances()) {
        const auto own = nearest_element(instance.node, [](const IfcElement&) { return true; });
        relations.elements.push_back(own && !own->element.id.empty() ? numbers.of(scope + std::string(own->element.id))
                                                                     : 0);
    }
    return relations;
}

LoadedShapes shapes_of(const MeshFile& file) {
    LoadedShapes loaded;
    std::map<std::vector<unsigned>, std::uint32_t> numbers;
    std::map<const aiNode*, std::uint32_t> parents;
    for (const MeshInstance& instance : file.instances()) {
        const auto meshes = instance.meshes();
        const auto [shape, is_new] = numbers.try_emplace({meshes.begin(), meshes.end()}, loaded.shapes.size());
        if (is_new) loaded.shapes.emplace_back(shape_of(file, instance));
        loaded.geometry.push_back(shape->second);
        loaded.poses.push_back(instance.pose.value());
        // Only the root has no parent, so no other node gets its parent number.
        loaded.parents.push_back(parents.try_emplace(instance.node->mParent, parents.size()).first->second);
    }
    return loaded;
}

LoadedTriangles triangles_of(const MeshFile& file) {
    LoadedTriangles loaded;
    loaded.owner_details = details_of(file);
    for (const MeshInstance& instance : file.instances()) {
        const auto owner = std::uint32_t(loaded.owner_names.size());
        loaded.owner_names.push_back(instance.name);
        for (const unsigned number : instance.meshes()) {
            const aiMesh& mesh = file.mesh(number);
            file.for_each_triangle(number, [&](const std::array<unsigned, 3>& corners) {
                Triangle3d triangle;
                for (unsigned k = 0; k < 3; ++k) {
                    triangle[k] = file.posed_vertex(instance, mesh, corners[k]).value;
                    for (const double value : triangle[k]) {
                        if (!std::isfinite(float(value)))
                            file.refuse_vertex(instance, corners[k], double(float(value)));
                    }
                }
                loaded.triangles.push_back(triangle);
                loaded.owners.push_back(owner);
            });
        }
    }
    return loaded;
}

shape::Mesh whole_mesh_of(const MeshFile& file) {
    shape::Mesh shape;
    for (const MeshInstance& instance : file.instances()) {
        for (const unsigned number : instance.meshes()) {
            const aiMesh& mesh = file.mesh(number);
            append_mesh(
                {file, number}, [&](unsigned index) { return file.posed_vertex(instance, mesh, index).value; }, shape);
        }
    }
    return shape;
}

}  // namespace octopair::io
