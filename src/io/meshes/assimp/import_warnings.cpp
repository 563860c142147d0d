// Facts about a file that Assimp imported and that users should know: warnings, content that was not read, axes and unit.
#include "io/meshes/assimp/scene_parts.hpp"

#include <algorithm>
#include <array>
#include <cstdint>
#include <span>
#include <string_view>
#include <unordered_map>
#include <unordered_set>
#include <utility>

#include <assimp/metadata.h>
#include <fmt/format.h>

#include "io/files/letter_case.hpp"
#include "io/formats/format_table.hpp"
#include "io/meshes/assimp/ifc_text.hpp"

namespace octopair::io {

namespace {

/// Returns a warning if octopair does not check how Assimp reads the format of the file, or an empty text.
std::string unchecked_format(const MeshFile& file) {
    const FileFormat* const format = file.known().format;
    if (format != nullptr && format->reader == FormatReader::checked_assimp) return {};
    const std::string name = format != nullptr ? std::string(format->name) : file.known().ending.substr(1);
    return fmt::format(
        "{}: Assimp reads {}; octopair does not vouch for it: check the number of objects and the bounds", file.path(),
        name);
}

/// Counts the elements that instances belong to, by GlobalId. Several elements may have the same id. An empty id stands for elements whose
/// node has a cut name.
std::unordered_map<std::string, std::uint64_t> elements_read(const MeshFile& file) {
    std::unordered_map<std::string, std::uint64_t> counts;
    std::unordered_set<const aiNode*> seen;
    for (const MeshInstance& instance : file.instances()) {
        for (const aiNode* node = instance.node; node != nullptr; node = node->mParent) {
            const auto element = parse_ifc_element({node->mName.C_Str(), node->mName.length});
            if (!element) continue;
            if (seen.insert(node).second) ++counts[std::string(element->id)];
            break;
        }
    }
    return counts;
}

/// Returns the id of an element, and its name if it has one.
std::string id_and_name(const IfcBody& body, const IfcText& text) {
    const auto name = text.names.find(body.id);
    return name == text.names.end() ? body.id : fmt::format("{} ('{}')", body.id, name->second);
}

void add_lost(const std::string& file, const IfcBody& body, const IfcText& text, std::vector<LostElements>& lost) {
    const auto same =
        std::find_if(lost.begin(), lost.end(), [&](const LostElements& known) { return known.type == body.type; });
    if (same != lost.end()) {
        ++same->count;
    } else {
        lost.push_back({file, body.type, 1, id_and_name(body, text)});
    }
}

/// Returns a warning about elements of an IFC file that have a body but no instance, or an empty text.
std::string lost_elements(const MeshFile& file) {
    const std::string words = elements_of(file).lost_text();
    if (words.empty()) return {};
    return fmt::format("{}: {}. Install octopair-ifc, or export the model as {}glTF or OBJ", file.path(), words,
                       in_upper_case(file.ifc_text().schema) == "IFC2X3" ? "" : "IFC2x3, ");
}

/// Returns what the importer of DirectX left out: corners beyond the vertices. Only binary files have them: a text is checked before.
std::vector<std::string> lost_corners(const MeshFile& file) {
    if (file.known().ending != ".x") return {};
    std::uint64_t faces = 0;
    for (const aiMesh* mesh : std::span(file.scene().mMeshes, file.scene().mNumMeshes)) {
        for (const aiFace& face : std::span(mesh->mFaces, mesh->mNumFaces)) faces += face.mNumIndices < 3;
    }
    if (faces == 0) return {};
    return {fmt::format("faces with fewer than three corners within the vertices ({})", faces)};
}

/// Returns the content that was left out, as far as the file and its importer show it.
std::vector<std::string> lost_parts(const MeshFile& file) {
    std::vector<std::string> lost = file.left_out();
    for (std::string& part : lost_corners(file)) lost.push_back(std::move(part));
    return lost;
}

}  // namespace

std::vector<std::string> import_warnings(const MeshFile& file) {
    std::vector<std::string> warnings = {unchecked_format(file), lost_elements(file)};
    if (const std::vector<std::string> lost = lost_parts(file); !lost.empty()) {
        warnings.push_back(fmt::format("{}: Assimp does not read {}; export the model as glTF, OBJ or STL", file.path(),
                                       fmt::join(lost, ", ")));
    }
    std::erase(warnings, "");
    return warnings;
}

ElementCounts elements_of(const MeshFile& file) {
    constexpr std::size_t long_name = 900;  // bytes; the name of the node may be cut, so it may have no id
    const IfcText& text = file.ifc_text();
    ElementCounts elements;
    auto read = elements_read(file);
    for (const IfcBody& body : text.bodies) {
        const auto name = text.names.find(body.id);
        const bool is_long = name != text.names.end() && name->second.size() >= long_name;
        std::uint64_t& same = read[body.id];
        std::uint64_t& cut = read[std::string()];
        ++elements.with_geometry;
        if (same > 0 || (is_long && cut > 0)) {
            --(same > 0 ? same : cut);
            ++elements.read;
        } else {
            add_lost(file.path(), body, text, elements.lost);
        }
    }
    for (const auto& [type, count] : text.left_out) elements.left_out.push_back({type, count});
    return elements;
}

std::vector<std::string> left_out_of(const MeshFile& file) {
    std::vector<std::string> left_out = lost_parts(file);
    for (const auto& [type, count] : file.ifc_text().left_out) left_out.push_back(fmt::format("{} ({})", type, count));
    if (const unsigned count = file.scene().mNumAnimations) left_out.push_back(fmt::format("animations ({})", count));
    return left_out;
}

SceneSpace MeshFile::space() const {
    SceneSpace result = format_space(path_);
    if (content_.unit) result.unit = *content_.unit;
    const aiMetadata* const facts = scene_->mMetaData;
    if (known_.ending != ".fbx" || facts == nullptr) return result;
    int up = -1, sign = 1;
    if (facts->Get("UpAxis", up) && (!facts->Get("UpAxisSign", sign) || sign > 0))
        result.up = up == 1 ? UpAxis::y : up == 2 ? UpAxis::z : UpAxis::unknown;
    float scale = 0;  // centimetres per unit of the file
    constexpr std::array<std::pair<float, const char*>, 5> units = {
        {{0.1f, "mm"}, {1, "cm"}, {100, "m"}, {2.54f, "in"}, {30.48f, "ft"}}};
    if (!facts->Get("UnitScaleFactor", scale)) return result;
    for (const auto& [size, name] : units) {
        if (scale == size) result.unit = name;
    }
    return result;
}

}  // namespace octopair::io
