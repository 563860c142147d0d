#include "io/meshes/content/irrlicht_content.hpp"

#include <algorithm>
#include <array>
#include <optional>

#include <fmt/format.h>

#include "io/files/failure.hpp"
#include "io/meshes/content/xml_tree.hpp"

namespace octopair::io {

namespace {

bool has_geometry(std::string_view type) {
    constexpr std::array<std::string_view, 7> types = {"mesh",   "octTree", "animatedMesh", "cube",
                                                       "sphere", "terrain", "skyBox"};
    return std::find(types.begin(), types.end(), type) != types.end();
}

}  // namespace

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

}  // namespace octopair::io
