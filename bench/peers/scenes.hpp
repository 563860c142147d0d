// The scenes of a comparison: generated ones and files, as float32 boxes.
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
    std::vector<std::string> kinds;      ///< of samples/scenes.hpp, seed 1
    std::vector<std::uint64_t> objects;  ///< of each kind
    std::vector<std::string> inputs;  ///< files of boxes, spheres or triangles; several also side by side as one scene
};

/// Hands out one scene after the other; the generated ones are not kept. Throws what making and reading scenes throws.
void for_each_scene(const SceneRequest& request, const std::function<void(const Scene&)>& body);

}  // namespace octopair::bench
