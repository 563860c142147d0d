#include "cli/input_set.hpp"

#include <fmt/format.h>

#include "cli/isolated_read.hpp"

namespace octopair::cli {

Objects InputSet::frame(std::uint64_t f) const {
    Objects objects = scene.frame(scene.moving ? f : 0);
    objects.padding = padding;
    return objects;
}

std::optional<std::string> InputSet::find_fault() const {
    const auto fault = io::find_fault(scene);
    if (!fault) return std::nullopt;
    const std::string frame = scene.moving ? fmt::format("frame {}: ", fault->frame) : "";
    std::uint64_t object = fault->object;
    for (const Part& part : parts) {
        if (object < part.objects) return fmt::format("{}: {}object {}: {}", part.path, frame, object, fault->what);
        object -= part.objects;
    }
    return std::nullopt;
}

InputSet read_input_set(const std::vector<std::string>& paths, io::MeshObjects mesh_objects,
                        const std::stop_token& stop) {
    InputSet set;
    std::vector<io::LoadedScene> scenes;
    for (const std::string& path : paths) {
        scenes.push_back(io::is_mesh_file(path) ? read_isolated(path, mesh_objects, stop)
                                                : io::read_scene(path, mesh_objects, stop));
        set.parts.push_back({path, scenes.back().objects});
    }
    set.scene = io::join_scenes(scenes, paths);
    return set;
}

}  // namespace octopair::cli
