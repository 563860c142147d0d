#include "peers/scenes.hpp"

#include <algorithm>
#include <variant>

#include "io/scene_reader.hpp"
#include "samples/scenes.hpp"

namespace octopair::bench {

namespace {

std::vector<Box3f> boxes_of(const io::LoadedScene& scene) {
    std::vector<Box3f> boxes(scene.objects);
    const auto copy = [&](const auto& from) {
        for (std::size_t i = 0; i < boxes.size(); ++i) {
            for (int axis = 0; axis < 3; ++axis) {
                boxes[i].min[axis] = float(from[i].min[axis]);
                boxes[i].max[axis] = float(from[i].max[axis]);
            }
        }
    };
    std::visit(copy, scene.boxes);
    return boxes;
}

/// Places scenes next to each other along x, with gaps of a tenth of the largest scene.
Scene side_by_side(const std::vector<Scene>& scenes) {
    Scene all{"all inputs side by side", {}};
    std::size_t objects = 0;
    for (const Scene& scene : scenes) objects += scene.boxes.size();
    all.boxes.reserve(objects);
    float at = 0;
    for (const Scene& scene : scenes) {
        float first = scene.boxes[0].min[0], last = scene.boxes[0].max[0];
        for (const Box3f& box : scene.boxes) {
            first = std::min(first, box.min[0]);
            last = std::max(last, box.max[0]);
        }
        for (Box3f box : scene.boxes) {
            box.min[0] += at - first;
            box.max[0] += at - first;
            all.boxes.push_back(box);
        }
        at += (last - first) * 1.1f;
    }
    return all;
}

Scene read(const std::string& path) {
    return {path.substr(path.find_last_of('/') + 1), boxes_of(io::read_scene(path, {io::MeshObjects::triangle}))};
}

}  // namespace

void for_each_scene(const SceneRequest& request, const std::function<void(const Scene&)>& body) {
    std::vector<Scene> real;
    real.reserve(request.inputs.size());
    for (const std::string& path : request.inputs) real.push_back(read(path));
    for (const std::uint64_t objects : request.objects) {
        for (const std::string& kind : request.kinds) body({kind, samples::make_scene(kind, objects, 1)});
    }
    for (const Scene& scene : real) body(scene);
    if (real.size() > 1) body(side_by_side(real));
}

}  // namespace octopair::bench
