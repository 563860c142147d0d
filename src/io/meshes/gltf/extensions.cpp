// Decides which extensions of glTF a file may require.
#include <algorithm>
#include <array>
#include <string_view>

#include <fmt/format.h>

#include "io/meshes/gltf/fields.hpp"
#include "io/meshes/gltf/gltf_file.hpp"

namespace octopair::io::gltf {

namespace {

using nlohmann::json;

constexpr std::string_view draco = "KHR_draco_mesh_compression", quantization = "KHR_mesh_quantization";

/// Extensions that change neither vertices nor the places of nodes. Nodes that KHR_node_visibility hides are read like others. All KHR_materials_... and ADOBE_materials_... are such, too.
constexpr std::array<std::string_view, 28> without_geometry = {"KHR_animation_pointer",
                                                               "KHR_audio_emitter",
                                                               "KHR_lights_punctual",
                                                               "KHR_node_hoverability",
                                                               "KHR_node_selectability",
                                                               "KHR_node_visibility",
                                                               "KHR_technique_webgl",
                                                               "KHR_techniques_webgl",
                                                               "KHR_texture_basisu",
                                                               "KHR_texture_transform",
                                                               "KHR_xmp",
                                                               "KHR_xmp_json_ld",
                                                               "EXT_instance_features",
                                                               "EXT_lights_ies",
                                                               "EXT_lights_image_based",
                                                               "EXT_mesh_features",
                                                               "EXT_mesh_manifold",
                                                               "EXT_structural_metadata",
                                                               "EXT_texture_avif",
                                                               "EXT_texture_webp",
                                                               "AGI_stk_metadata",
                                                               "CESIUM_primitive_outline",
                                                               "FB_geometry_metadata",
                                                               "GODOT_single_root",
                                                               "MSFT_lod",
                                                               "MSFT_packing_normalRoughnessMetallic",
                                                               "MSFT_packing_occlusionRoughnessMetallic",
                                                               "MSFT_texture_dds"};

bool is_accepted(std::string_view name) {
    if (name == draco || name == quantization || name == instancing) return true;
    if (name.starts_with("KHR_materials_") || name.starts_with("ADOBE_materials_")) return true;
    return std::find(without_geometry.begin(), without_geometry.end(), name) != without_geometry.end();
}

/// Returns what to do about an extension that is refused.
std::string_view remedy_for(std::string_view name) {
    if (name.ends_with("_meshopt_compression"))
        return "write the file without compression, for example with `gltf-transform copy IN.glb OUT.glb`";
    return "it may change the geometry; write the file without it";
}

bool uses(const GltfFile& file, std::string_view extension) {
    const json::array_t& used = array_or_empty(file.fields(), "extensionsUsed");
    return std::any_of(used.begin(), used.end(), [&](const json& name) {
        return name.is_string() && name.get_ref<const std::string&>() == extension;
    });
}

/// Returns whether a primitive has its vertices or indices only in compressed form.
bool is_only_compressed(const GltfFile& file, const JsonFields& primitive) {
    if (extension_of(primitive, draco) == nullptr) return false;
    const auto lacks_data = [&](const JsonFields& fields, std::string_view key) {
        return fields.find(key) != nullptr &&
               file.item("accessors", whole_number(fields, key)).find("bufferView") == nullptr;
    };
    const JsonFields attributes(primitive.required("attributes"), primitive.place_of("attributes"));
    return lacks_data(attributes, "POSITION") || lacks_data(primitive, "indices");
}

bool has_compressed_mesh(const GltfFile& file) {
    for (std::size_t i = 0; i < file.count("meshes"); ++i) {
        const JsonFields mesh = file.item("meshes", i);
        for (const json& value : array_or_empty(mesh, "primitives")) {
            if (is_only_compressed(file, JsonFields(value, mesh.place_of("primitives")))) return true;
        }
    }
    return false;
}

}  // namespace

void check_required_extensions(const GltfFile& file) {
    const JsonFields fields = file.fields();
    for (const json& value : array_or_empty(fields, "extensionsRequired")) {
        const std::string& name = json_text(value, fields.place_of("extensionsRequired"));
        if (is_accepted(name)) continue;
        fields.refuse_key("extensionsRequired", fmt::format("the file needs {}, which octopair does not read; {}",
                                                            shown_text(name), remedy_for(name)));
    }
}

bool needs_assimp(const GltfFile& file) {
    if (!has_compressed_mesh(file)) return false;
    for (const std::string_view other : {quantization, std::string_view(instancing)}) {
        if (!uses(file, other)) continue;
        refuse(file.path(), fmt::format("uses {} and {}, which octopair does not read together; write the file without "
                                        "compression, for example with `gltf-transform copy IN.glb OUT.glb`",
                                        draco, other));
    }
    return true;
}

}  // namespace octopair::io::gltf
