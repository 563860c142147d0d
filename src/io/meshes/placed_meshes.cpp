#include "io/meshes/placed_meshes.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <utility>

#include <fmt/format.h>

#include "io/files/failure.hpp"
#include "octopair/error.hpp"

namespace octopair::io {

namespace {

/// The objects of a file, their meshes, and the limits of reading.
struct WorldView {
    const PlacedMeshes& placed;
    ReadBudget& budget;

    const SharedMesh& mesh(const PlacedMesh& object) const { return placed.meshes[object.mesh]; }
};

/// Returns a vertex in the world. Throws: Error{bad_input} if it is not finite.
BoundedPoint posed(const WorldView& world, const PlacedMesh& object, const Point3d& vertex) {
    const BoundedPoint point = object.pose.apply(vertex);
    for (std::size_t axis = 0; axis < 3; ++axis) {
        for (const double coordinate : {point.value[axis], point.low[axis], point.high[axis]}) {
            if (std::isfinite(coordinate)) continue;
            refuse(world.budget.path(), fmt::format("{} '{}': its transforms move the vertex {:.6g}, {:.6g}, {:.6g} "
                                                    "to the coordinate {}, which is not finite",
                                                    world.placed.noun, object.name, vertex[0], vertex[1], vertex[2],
                                                    number_text(coordinate)));
        }
    }
    return point;
}

Box3d box_of(const WorldView& world, const PlacedMesh& object) {
    constexpr double infinity = std::numeric_limits<double>::infinity();
    Box3d box{{infinity, infinity, infinity}, {-infinity, -infinity, -infinity}};
    std::size_t count = 0;
    for (const auto* const vertices : {&world.mesh(object).triangles.vertices, &world.mesh(object).loose}) {
        for (const Point3d& vertex : *vertices) {
            if (++count % 65536 == 0) world.budget.checkpoint();
            const BoundedPoint point = posed(world, object, vertex);
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
std::vector<Point3d> world_vertices(const WorldView& world, const PlacedMesh& object) {
    std::vector<Point3d> places;
    places.reserve(world.mesh(object).triangles.vertices.size());
    for (const Point3d& vertex : world.mesh(object).triangles.vertices) {
        if (places.size() % 65536 == 0) world.budget.checkpoint();
        places.push_back(posed(world, object, vertex).value);
        for (const double coordinate : places.back()) {
            if (std::isfinite(float(coordinate))) continue;
            refuse(world.budget.path(), fmt::format("{} '{}': the coordinate {} is beyond the range of float32",
                                                    world.placed.noun, object.name, number_text(coordinate)));
        }
    }
    return places;
}

ObjectDetails details_of(const WorldView& world) {
    ObjectDetails details;
    DetailsBuilder builder(details);
    for (const PlacedMesh& object : world.placed.objects) {
        DetailTexts texts;
        texts[std::size_t(Detail::label)] = object.label;
        texts[std::size_t(Detail::parent)] = object.parent_label;
        texts[std::size_t(Detail::material)] = joined_materials(world.mesh(object).materials);
        builder.add(texts);
    }
    return details;
}

/// Returns the shapes of all objects. Moves them out of the meshes.
LoadedShapes take_shapes(PlacedMeshes& placed) {
    LoadedShapes loaded;
    std::map<std::size_t, std::uint32_t> numbers;
    std::map<std::uint64_t, std::uint32_t> parents;
    for (const PlacedMesh& object : placed.objects) {
        const auto [number, is_new] = numbers.try_emplace(object.mesh, std::uint32_t(loaded.shapes.size()));
        if (is_new) loaded.shapes.emplace_back(std::move(placed.meshes[object.mesh].triangles));
        loaded.geometry.push_back(number->second);
        loaded.poses.push_back(object.pose.value());
        loaded.parents.push_back(parents.try_emplace(object.parent, std::uint32_t(parents.size())).first->second);
    }
    return loaded;
}

LoadedScene object_scene(PlacedMeshes& placed, bool shapes, ReadBudget& budget) {
    const WorldView world{placed, budget};
    LoadedScene scene;
    scene.objects = placed.objects.size();
    Buffer<Box3d> boxes{placed.objects.size()};
    for (std::size_t i = 0; i < placed.objects.size(); ++i) {
        if (i % 1024 == 0) budget.checkpoint();
        boxes.data()[i] = box_of(world, placed.objects[i]);
    }
    scene.boxes = std::move(boxes);
    scene.details = details_of(world);
    for (PlacedMesh& object : placed.objects) scene.names.push_back(std::move(object.name));
    if (shapes) scene.shapes = take_shapes(placed);
    return scene;
}

LoadedScene triangle_scene(const WorldView& world) {
    LoadedScene scene;
    for (const PlacedMesh& object : world.placed.objects)
        scene.objects += world.mesh(object).triangles.triangles.size();
    world.budget.charge(scene.objects, sizeof(Box3f));
    Buffer<Box3f> boxes{std::size_t(scene.objects)};
    Box3f* next = boxes.data();
    for (const PlacedMesh& object : world.placed.objects) {
        const std::vector<Point3d> places = world_vertices(world, object);
        for (const auto& corners : world.mesh(object).triangles.triangles) {
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

LoadedScene exact_triangle_scene(const WorldView& world) {
    LoadedScene scene;
    LoadedTriangles& loaded = scene.triangles.emplace();
    loaded.owner_details = details_of(world);
    for (const PlacedMesh& object : world.placed.objects) {
        const auto owner = std::uint32_t(loaded.owner_names.size());
        loaded.owner_names.push_back(object.name);
        const auto& triangles = world.mesh(object).triangles.triangles;
        world.budget.charge(triangles.size(), sizeof(Triangle3d) + sizeof owner);
        const std::vector<Point3d> places = world_vertices(world, object);
        for (const auto& [a, b, c] : triangles) loaded.triangles.push_back({places[a], places[b], places[c]});
        loaded.owners.resize(loaded.triangles.size(), owner);
    }
    scene.objects = loaded.triangles.size();
    return scene;
}

/// Converts all coordinates. Each of them is rounded once, as if the file had the other unit.
void convert(PlacedMeshes& placed, const UnitChange& change) {
    for (SharedMesh& mesh : placed.meshes) {
        for (auto* const vertices : {&mesh.triangles.vertices, &mesh.loose}) {
            for (Point3d& vertex : *vertices) std::transform(vertex.begin(), vertex.end(), vertex.begin(), change);
        }
    }
    for (PlacedMesh& object : placed.objects) object.pose = object.pose.converted(change);
}

LoadedScene converted_scene(PlacedMeshes& placed, const SceneContent& content, ReadBudget& budget) {
    if (content.objects == MeshObjects::node) return object_scene(placed, content.shapes, budget);
    const WorldView world{placed, budget};
    return content.shapes ? exact_triangle_scene(world) : triangle_scene(world);
}

}  // namespace

void remove_unused_vertices(std::vector<Point3d>& vertices, std::span<std::uint32_t> corners) {
    constexpr std::uint32_t unused = std::numeric_limits<std::uint32_t>::max();
    std::vector<std::uint32_t> numbers(vertices.size(), unused);
    for (const std::uint32_t corner : corners) numbers[corner] = 0;
    std::uint32_t used = 0;
    for (std::size_t i = 0; i < numbers.size(); ++i) {
        if (numbers[i] == unused) continue;
        vertices[used] = vertices[i];
        numbers[i] = used++;
    }
    vertices.resize(used);
    for (std::uint32_t& corner : corners) corner = numbers[corner];
}

LoadedScene scene_of(PlacedMeshes& placed, const SceneContent& content, ReadBudget& budget) {
    const UnitChange change(placed.unit, content.unit);
    if (!change.is_none()) convert(placed, change);
    LoadedScene scene = converted_scene(placed, content, budget);
    scene.set_unit(placed.unit, content.unit);
    return scene;
}

shape::Mesh whole_mesh_of(const PlacedMeshes& placed, ReadBudget& budget) {
    const WorldView world{placed, budget};
    shape::Mesh whole;
    for (const PlacedMesh& object : placed.objects) {
        const shape::Mesh& own = world.mesh(object).triangles;
        budget.charge(own.vertices.size(), sizeof(Point3d));
        budget.charge(own.triangles.size(), sizeof own.triangles[0]);
        const std::uint64_t first = whole.vertices.size();
        if (first + own.vertices.size() > std::numeric_limits<std::uint32_t>::max()) {
            throw Error(ErrorCode::resource_limit, fmt::format("{}: has more than 2^32 - 1 vertices", budget.path()));
        }
        for (const Point3d& vertex : own.vertices) whole.vertices.push_back(posed(world, object, vertex).value);
        const auto base = std::uint32_t(first);
        for (const auto& [a, b, c] : own.triangles) whole.triangles.push_back({a + base, b + base, c + base});
    }
    return whole;
}

}  // namespace octopair::io
