#include "io/meshes/assimp/mesh_reader.hpp"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>

#include "io/meshes/assimp/mesh_file.hpp"
#include "io/meshes/assimp/scene_parts.hpp"

namespace octopair::io {

namespace {

template <typename T>
Buffer<T> copy_of(const std::vector<T>& boxes) {
    Buffer<T> copy{boxes.size()};
    std::copy(boxes.begin(), boxes.end(), copy.data());
    return copy;
}

Box3d box_of(const MeshFile& file, const MeshInstance& instance) {
    constexpr double infinity = std::numeric_limits<double>::infinity();
    Box3d box{{infinity, infinity, infinity}, {-infinity, -infinity, -infinity}};
    for (const unsigned number : instance.meshes()) {
        for (const unsigned index : file.used_vertices(number)) {
            const BoundedPoint point = file.posed_vertex(instance, file.mesh(number), index);
            for (int axis = 0; axis < 3; ++axis) {
                box.min[axis] = std::min(box.min[axis], point.low[axis]);
                box.max[axis] = std::max(box.max[axis], point.high[axis]);
            }
        }
    }
    return box;
}

LoadedScene node_scene(const MeshFile& file) {
    LoadedScene scene;
    std::vector<Box3d> boxes;
    for (const MeshInstance& instance : file.instances()) {
        boxes.push_back(box_of(file, instance));
        scene.names.push_back(instance.name);
    }
    scene.objects = boxes.size();
    scene.boxes = copy_of(boxes);
    return scene;
}

void append_triangles(const MeshFile& file, const MeshInstance& instance, unsigned number, std::vector<Box3f>& boxes) {
    const aiMesh& mesh = file.mesh(number);
    file.for_each_triangle(number, [&](const std::array<unsigned, 3>& corners) {
        Box3f box;
        for (unsigned k = 0; k < 3; ++k) {
            const BoundedPoint point = file.posed_vertex(instance, mesh, corners[k]);
            for (int axis = 0; axis < 3; ++axis) {
                const float value = float(point.value[axis]);
                if (!std::isfinite(value)) file.refuse_vertex(instance, corners[k], double(value));
                box.min[axis] = k == 0 ? value : std::min(box.min[axis], value);
                box.max[axis] = k == 0 ? value : std::max(box.max[axis], value);
            }
        }
        boxes.push_back(box);
    });
}

LoadedScene triangle_scene(const MeshFile& file) {
    std::vector<Box3f> boxes;
    for (const MeshInstance& instance : file.instances()) {
        for (const unsigned number : instance.meshes()) append_triangles(file, instance, number, boxes);
    }
    LoadedScene scene;
    scene.objects = boxes.size();
    scene.boxes = copy_of(boxes);
    return scene;
}

/// Returns a scene with triangles and without boxes.
LoadedScene exact_triangle_scene(const MeshFile& file) {
    LoadedScene scene;
    scene.triangles = triangles_of(file);
    scene.objects = scene.triangles->triangles.size();
    return scene;
}

}  // namespace

bool is_mesh_ending(std::string_view ending) {
    return ending.size() > 1 && Assimp::Importer().IsExtensionSupported(std::string(ending));
}

LoadedScene read_mesh_scene(const std::string& path, const SceneContent& content) {
    const bool by_triangle = content.objects == MeshObjects::triangle;
    const MeshFile file(path, by_triangle || content.shapes, content.unit);
    LoadedScene scene;
    if (by_triangle) {
        scene = content.shapes ? exact_triangle_scene(file) : triangle_scene(file);
    } else {
        scene = node_scene(file);
        scene.details = details_of(file);
        scene.relations = relations_of(file);
        if (content.shapes) scene.shapes = shapes_of(file);
    }
    scene.project = file.ifc_text().project;
    const std::string file_name = std::filesystem::path(path).filename().string();
    if (file.scene().mRootNode->mName.C_Str() == file_name) scene.root = file_name;
    scene.largest_rounded = file.largest_rounded();
    const SceneSpace of_file = file.space();
    scene.space.up = of_file.up;
    scene.set_unit(of_file.unit, content.unit);
    scene.warnings = import_warnings(file);
    scene.elements = elements_of(file);
    scene.not_read = left_out_of(file);
    file.crossing_faces().append_warning(path, scene.warnings);
    return scene;
}

}  // namespace octopair::io
