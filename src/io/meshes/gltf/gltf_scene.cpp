#include "io/meshes/gltf/gltf_scene.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <utility>

#include <fmt/format.h>

#include "io/files/failure.hpp"
#include "io/meshes/gltf/extensions.hpp"
#include "io/meshes/gltf/gltf_model.hpp"
#include "octopair/error.hpp"

namespace octopair::io {

namespace {

using gltf::GltfFile;
using gltf::GltfMesh;
using gltf::GltfModel;
using gltf::Instance;

/// Checks what a file needs. Returns whether Assimp must read it.
bool is_for_assimp(const GltfFile& file) {
    if (!file.version().starts_with('1') && !file.version().starts_with('2'))
        refuse(file.path(), fmt::format("is of glTF {}; octopair reads glTF 2 and 1.0", shown_text(file.version())));
    if (file.version().starts_with('1')) return true;
    gltf::check_required_extensions(file);
    return gltf::needs_assimp(file);
}

/// Returns a vertex in the world. Throws: Error{bad_input} if it is not finite.
BoundedPoint posed(const GltfModel& model, const Instance& instance, const Point3d& vertex) {
    const BoundedPoint point = instance.pose.apply(vertex);
    for (std::size_t axis = 0; axis < 3; ++axis) {
        for (const double at : {point.value[axis], point.low[axis], point.high[axis]}) {
            if (std::isfinite(at)) continue;
            refuse(model.file().path(), fmt::format("node '{}': its transforms move the vertex {:.6g}, {:.6g}, {:.6g} "
                                                    "to the coordinate {}, which is not finite",
                                                    instance.name, vertex[0], vertex[1], vertex[2], number_text(at)));
        }
    }
    return point;
}

Box3d box_of(const GltfModel& model, const Instance& instance) {
    constexpr double infinity = std::numeric_limits<double>::infinity();
    Box3d box{{infinity, infinity, infinity}, {-infinity, -infinity, -infinity}};
    std::size_t count = 0;
    for (const auto* const vertices : {&model.mesh(instance).triangles.vertices, &model.mesh(instance).loose}) {
        for (const Point3d& vertex : *vertices) {
            if (++count % 65536 == 0) model.file().checkpoint();
            const BoundedPoint point = posed(model, instance, vertex);
            for (std::size_t axis = 0; axis < 3; ++axis) {
                box.min[axis] = std::min(box.min[axis], point.low[axis]);
                box.max[axis] = std::max(box.max[axis], point.high[axis]);
            }
        }
    }
    return box;
}

/// Returns the vertices of triangles in the world. Throws: Error{bad_input} if one is beyond the range of float32, because boxes of
/// triangles are float32.
std::vector<Point3d> world_vertices(const GltfModel& model, const Instance& instance) {
    std::vector<Point3d> places;
    places.reserve(model.mesh(instance).triangles.vertices.size());
    for (const Point3d& vertex : model.mesh(instance).triangles.vertices) {
        if (places.size() % 65536 == 0) model.file().checkpoint();
        places.push_back(posed(model, instance, vertex).value);
        for (const double at : places.back()) {
            if (std::isfinite(float(at))) continue;
            refuse(model.file().path(), fmt::format("node '{}': the coordinate {} is beyond the range of float32",
                                                    instance.name, number_text(at)));
        }
    }
    return places;
}

ObjectDetails details_of(const GltfModel& model) {
    ObjectDetails details;
    DetailsBuilder builder(details);
    for (const Instance& instance : model.instances()) {
        DetailTexts texts;
        texts[std::size_t(Detail::label)] = model.tree().nodes()[instance.node].label;
        texts[std::size_t(Detail::parent)] = model.tree().parent_label(instance.node);
        texts[std::size_t(Detail::material)] = joined_materials(model.mesh(instance).materials);
        builder.add(texts);
    }
    return details;
}

/// Returns the shapes of all instances. Takes them from the model.
LoadedShapes take_shapes(GltfModel& model) {
    LoadedShapes loaded;
    std::map<std::uint64_t, std::uint32_t> numbers;
    std::map<std::size_t, std::uint32_t> parents;
    for (const Instance& instance : model.instances()) {
        const auto [number, is_new] = numbers.try_emplace(instance.mesh, std::uint32_t(loaded.shapes.size()));
        if (is_new) loaded.shapes.emplace_back(std::move(model.mesh(instance).triangles));
        loaded.geometry.push_back(number->second);
        loaded.poses.push_back(instance.pose.value());
        const std::size_t parent = model.tree().nodes()[instance.node].parent;
        loaded.parents.push_back(parents.try_emplace(parent, std::uint32_t(parents.size())).first->second);
    }
    return loaded;
}

LoadedScene node_scene(GltfModel& model, bool shapes) {
    LoadedScene scene;
    const std::vector<Instance>& instances = model.instances();
    scene.objects = instances.size();
    Buffer<Box3d> boxes{instances.size()};
    for (std::size_t i = 0; i < instances.size(); ++i) {
        if (i % 1024 == 0) model.file().checkpoint();
        boxes.data()[i] = box_of(model, instances[i]);
        scene.names.push_back(instances[i].name);
    }
    scene.boxes = std::move(boxes);
    scene.details = details_of(model);
    if (shapes) scene.shapes = take_shapes(model);
    return scene;
}

LoadedScene triangle_scene(const GltfModel& model) {
    LoadedScene scene;
    for (const Instance& instance : model.instances()) scene.objects += model.mesh(instance).triangles.triangles.size();
    model.file().charge(scene.objects, sizeof(Box3f));
    Buffer<Box3f> boxes{std::size_t(scene.objects)};
    Box3f* next = boxes.data();
    for (const Instance& instance : model.instances()) {
        const std::vector<Point3d> places = world_vertices(model, instance);
        for (const auto& corners : model.mesh(instance).triangles.triangles) {
            for (std::size_t axis = 0; axis < 3; ++axis) {
                const std::array<float, 3> at = {float(places[corners[0]][axis]), float(places[corners[1]][axis]),
                                                 float(places[corners[2]][axis])};
                next->min[axis] = std::min({at[0], at[1], at[2]});
                next->max[axis] = std::max({at[0], at[1], at[2]});
            }
            ++next;
        }
    }
    scene.boxes = std::move(boxes);
    return scene;
}

LoadedScene exact_triangle_scene(const GltfModel& model) {
    LoadedScene scene;
    LoadedTriangles& loaded = scene.triangles.emplace();
    loaded.owner_details = details_of(model);
    for (const Instance& instance : model.instances()) {
        const auto owner = std::uint32_t(loaded.owner_names.size());
        loaded.owner_names.push_back(instance.name);
        const auto& triangles = model.mesh(instance).triangles.triangles;
        model.file().charge(triangles.size(), sizeof(Triangle3d) + sizeof owner);
        const std::vector<Point3d> places = world_vertices(model, instance);
        for (const auto& [a, b, c] : triangles) loaded.triangles.push_back({places[a], places[b], places[c]});
        loaded.owners.resize(loaded.triangles.size(), owner);
    }
    scene.objects = loaded.triangles.size();
    return scene;
}

LoadedScene scene_of(GltfFile& file, const SceneContent& content) {
    GltfModel model(file, content.progress);
    const double largest = model.largest_rounded();
    std::vector<std::string> warnings = model.warnings();
    LoadedScene scene;
    if (content.objects == MeshObjects::node) {
        scene = node_scene(model, content.shapes);
    } else {
        scene = content.shapes ? exact_triangle_scene(model) : triangle_scene(model);
    }
    scene.largest_rounded = largest;
    scene.warnings = std::move(warnings);
    scene.space = {UpAxis::y, "m"};
    return scene;
}

}  // namespace

bool is_gltf_ending(std::string_view ending) { return ending == ".gltf" || ending == ".glb"; }

bool may_be_gltf_for_assimp(const std::string& path) { return gltf::may_need_assimp(path); }

std::optional<LoadedScene> read_gltf_scene(const std::string& path, const SceneContent& content,
                                           const std::stop_token& stop) {
    GltfFile file(path, stop);
    if (is_for_assimp(file)) return std::nullopt;
    return scene_of(file, content);
}

std::optional<LoadedScene> parse_gltf_scene(const std::string& path, Buffer<std::byte> bytes,
                                            const SceneContent& content, const std::stop_token& stop) {
    GltfFile file(path, std::move(bytes), stop);
    if (is_for_assimp(file)) return std::nullopt;
    return scene_of(file, content);
}

std::optional<shape::Mesh> read_gltf_mesh(const std::string& path, LoadedScene& scene, const std::stop_token& stop) {
    GltfFile file(path, stop);
    if (is_for_assimp(file)) return std::nullopt;
    const GltfModel model(file, {});
    scene.largest_rounded = std::max(scene.largest_rounded, model.largest_rounded());
    const std::vector<std::string> warnings = model.warnings();
    scene.warnings.insert(scene.warnings.end(), warnings.begin(), warnings.end());
    shape::Mesh whole;
    for (const Instance& instance : model.instances()) {
        const shape::Mesh& own = model.mesh(instance).triangles;
        file.charge(own.vertices.size(), sizeof(Point3d));
        file.charge(own.triangles.size(), sizeof own.triangles[0]);
        const std::uint64_t first = whole.vertices.size();
        if (first + own.vertices.size() > std::numeric_limits<std::uint32_t>::max())
            throw Error(ErrorCode::resource_limit, fmt::format("{}: has more than 2^32 - 1 vertices", path));
        for (const Point3d& vertex : own.vertices) whole.vertices.push_back(posed(model, instance, vertex).value);
        const auto base = std::uint32_t(first);
        for (const auto& [a, b, c] : own.triangles) whole.triangles.push_back({a + base, b + base, c + base});
    }
    return whole;
}

}  // namespace octopair::io
