// Scenes of a comparison, generated or read from files, as float32 boxes.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "octopair/objects.hpp"

namespace octopair::bench {

struct Scene {
    std::string name;
    std::vector<Box3f> boxes;
};

struct SceneRequest {
    std::vector<std::string> kinds;      ///< kinds of samples/scenes.hpp, seed 1
    std::vector<std::uint64_t> objects;  ///< numbers of objects for each kind
    std::vector<std::string> inputs;  ///< files of boxes, spheres or triangles; several files also form a joint scene
};

/// Calls `body` for one scene after the other, and does not keep generated scenes. Throws: errors of making and reading
/// scenes.
void for_each_scene(const SceneRequest& request, const std::function<void(const Scene&)>& body);

}  // namespace octopair::bench
