#include "io/meshes/assimp/content/mesh_content.hpp"

#include <algorithm>
#include <array>
#include <optional>
#include <span>

#include <fmt/format.h>

#include "base/memory.hpp"
#include "io/files/failure.hpp"
#include "io/files/input_file.hpp"
#include "io/meshes/xml/xml_tree.hpp"

namespace octopair::io {

namespace {

/// Checks that the text is well-formed XML, and nothing else.
MeshContent check_xml(const std::string& path, std::string_view text) {
    (void)XmlTree(path, text);
    return {};
}

bool has_geometry(std::string_view type) {
    constexpr std::array<std::string_view, 7> types = {"mesh",   "octTree", "animatedMesh", "cube",
                                                       "sphere", "terrain", "skyBox"};
    return std::find(types.begin(), types.end(), type) != types.end();
}

/// Refuses scenes of Irrlicht (.irr): Assimp 5.2 finds no object in them, and reports no error.
/// Throws: Error{bad_input} with the line of the first object.
MeshContent check_irrlicht(const std::string& path, std::string_view bytes) {
    const XmlTree tree(path, bytes);
    std::optional<XmlElement> first;
    std::size_t objects = 0;
    for (std::size_t i = 0; i < tree.size(); ++i) {
        const XmlElement element = tree.at(i);
        if (element.name() != "node" || !has_geometry(element.attribute("type").value_or(""))) continue;
        if (!first) first = element;
        ++objects;
    }
    if (first)
        first->refuse(
            fmt::format("Assimp reads none of the {} objects of an Irrlicht scene; export glTF, OBJ or STL", objects));
    return {};
}

struct ContentCheck {
    std::string_view ending;
    MeshContent (*check)(const std::string& path, std::string_view bytes);
};

constexpr auto checks = std::to_array<ContentCheck>({
    {".ac", &correct_ac3d},
    {".ac3d", &correct_ac3d},
    {".acc", &correct_ac3d},
    {".amf", &correct_amf},
    {".dae", &correct_collada},
    {".ogex", &check_opengex},
    {".x", &correct_directx},
    {".dxf", &correct_dxf},
    {".irr", &check_irrlicht},
    {".irrmesh", &check_xml},
    {".x3d", &correct_x3d},
    {".xgl", &correct_xgl},
    {".xml", &check_xml},
    {".zgl", &correct_zgl},
});

}  // namespace

std::vector<std::string> LeftOut::list() const {
    std::vector<std::string> texts;
    texts.reserve(counts_.size());
    for (const auto& [what, count] : counts_) texts.push_back(fmt::format("{} ({})", what, count));
    return texts;
}

MeshContent check_mesh_content(const std::string& path, const KnownFormat& known) {
    const auto found = std::find_if(checks.begin(), checks.end(),
                                    [&](const ContentCheck& check) { return check.ending == known.ending; });
    if (found == checks.end()) return {};
    const InputFile file(path);
    Buffer<char> bytes{std::size_t(file.size())};
    file.read(0, std::as_writable_bytes(bytes.span()));
    return found->check(path, {bytes.data(), bytes.size()});
}

}  // namespace octopair::io
