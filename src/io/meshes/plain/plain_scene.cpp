// Scenes of mesh files of simple formats.
#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <limits>
#include <unordered_set>
#include <utility>

#include <fmt/format.h>

#include "io/files/failure.hpp"
#include "io/files/input_file.hpp"
#include "io/formats/format_choice.hpp"
#include "io/meshes/placed_meshes.hpp"
#include "io/meshes/plain/plain_mesh.hpp"

namespace octopair::io {

namespace {

std::vector<PlainMesh> parse(const FileContent& file, std::string_view ending) {
    if (ending == ".obj") return parse_obj(file);
    if (ending == ".stl") return parse_stl(file);
    std::vector<PlainMesh> meshes;
    meshes.push_back(ending == ".ply" ? parse_ply(file) : parse_off(file));
    return meshes;
}

/// Returns the largest absolute coordinate of the meshes that have float32 coordinates; 0 if there are none.
double largest_rounded(const std::vector<PlainMesh>& meshes) {
    double largest = 0;
    for (const PlainMesh& mesh : meshes) {
        if (!mesh.rounded) continue;
        for (const Point3d& place : mesh.vertices) {
            for (const double coordinate : place) largest = std::max(largest, std::abs(coordinate));
        }
    }
    return largest;
}

/// Reads the meshes of a file. Adds its warnings to those of `scene`, and sets the bound on its rounded coordinates.
std::vector<PlainMesh> read_meshes(const std::string& path, const std::stop_token& stop,
                                   const std::function<void(double)>& progress, LoadedScene& scene) {
    const InputFile input(path);
    if (input.size() == 0) refuse(path, "is empty");
    Buffer<char> bytes{std::size_t(input.size())};
    input.read(0, std::as_writable_bytes(bytes.span()), stop);
    std::vector<PlainMesh> meshes =
        parse({{bytes.data(), bytes.size()}, path, stop, progress, &scene.warnings}, format_ending(path));
    scene.largest_rounded = std::max(scene.largest_rounded, largest_rounded(meshes));
    return meshes;
}

/// Polls for a stop request. Loops over meshes call this for each mesh. Throws: Error{cancelled} now and then after a stop request.
void check_stop(std::size_t mesh, const std::stop_token& stop) {
    if (mesh % 4096 == 0 && stop.stop_requested()) cancel();
}

/// Returns the names of meshes. If a name would occur twice, "#" and the position of the mesh follow it.
std::vector<std::string> names_of(const std::vector<PlainMesh>& meshes, const std::string& path,
                                  const std::stop_token& stop) {
    const std::string file = std::filesystem::path(path).filename().string();
    // The only solid of an STL file often has the name of the program that wrote it.
    const bool by_file = meshes.size() == 1 && (meshes[0].name.empty() || format_ending(path) == ".stl");
    if (by_file) return {file};
    std::vector<std::string> names;
    std::unordered_set<std::string> known;
    for (std::size_t i = 0; i < meshes.size(); ++i) {
        check_stop(i, stop);
        std::string name = fmt::format("{}/{}", file, meshes[i].name.empty() ? fmt::format("#{}", i) : meshes[i].name);
        while (!known.insert(name).second) name += fmt::format("#{}", i);
        names.push_back(std::move(name));
    }
    return names;
}

/// Returns the details of all meshes. `names`: result of names_of().
ObjectDetails details_of(const std::vector<PlainMesh>& meshes, const std::vector<std::string>& names,
                         const std::stop_token& stop) {
    ObjectDetails details;
    DetailsBuilder builder(details);
    for (std::size_t i = 0; i < meshes.size(); ++i) {
        check_stop(i, stop);
        const std::size_t slash = names[i].find('/');
        const bool is_part = slash != std::string::npos;
        DetailTexts texts;
        texts[std::size_t(Detail::label)] = is_part ? names[i].substr(slash + 1) : names[i];
        if (is_part) texts[std::size_t(Detail::parent)] = names[i].substr(0, slash);
        texts[std::size_t(Detail::material)] = joined_materials(meshes[i].materials);
        builder.add(texts);
    }
    return details;
}

Box3d box_of(const std::vector<Point3d>& places) {
    constexpr double infinity = std::numeric_limits<double>::infinity();
    Box3d box{{infinity, infinity, infinity}, {-infinity, -infinity, -infinity}};
    for (const Point3d& place : places) {
        for (std::size_t axis = 0; axis < 3; ++axis) {
            box.min[axis] = std::min(box.min[axis], place[axis]);
            box.max[axis] = std::max(box.max[axis], place[axis]);
        }
    }
    return box;
}

/// Adds the meshes as objects with boxes. Removes meshes and vertices that are not used.
void add_objects(std::vector<PlainMesh>& meshes, const std::string& path, LoadedScene& scene,
                 const std::stop_token& stop) {
    for (std::size_t i = 0; i < meshes.size(); ++i) {
        check_stop(i, stop);
        // All vertices count for the box of a mesh without faces.
        if (!meshes[i].corners.empty()) remove_unused_vertices(meshes[i].vertices, meshes[i].corners);
    }
    std::erase_if(meshes, [](const PlainMesh& mesh) { return mesh.vertices.empty(); });
    scene.objects = meshes.size();
    scene.names = names_of(meshes, path, stop);
    if (meshes.empty()) scene.names.clear();
    scene.details = details_of(meshes, scene.names, stop);
    Buffer<Box3d> boxes{meshes.size()};
    std::transform(meshes.begin(), meshes.end(), boxes.data(),
                   [](const PlainMesh& mesh) { return box_of(mesh.vertices); });
    scene.boxes = std::move(boxes);
}

/// Adds the shapes of the objects, and warnings about their faces.
void add_shapes(std::vector<PlainMesh> meshes, const std::string& path, LoadedScene& scene,
                const std::stop_token& stop) {
    LoadedShapes& loaded = scene.shapes.emplace();
    CrossingFaces crossing;
    for (std::size_t i = 0; i < meshes.size(); ++i) {
        meshes[i].name = scene.names[i];
        loaded.geometry.push_back(std::uint32_t(loaded.shapes.size()));
        loaded.shapes.emplace_back(cut_into_triangles(std::move(meshes[i]), crossing, stop));
    }
    crossing.append_warning(path, scene.warnings);
    loaded.poses.resize(meshes.size());
    loaded.parents.resize(meshes.size(), 0);
}

/// Throws: Error{bad_input} if a coordinate is beyond the range of float32.
float rounded(double coordinate, const std::string& path) {
    const auto value = float(coordinate);
    if (!std::isfinite(value)) {
        refuse(path, fmt::format("the coordinate {} is beyond the range of float32, which boxes of triangles have; use "
                                 "--objects node",
                                 number_text(coordinate)));
    }
    return value;
}

/// Returns the triangles of all meshes. Adds warnings about their faces to `warnings`.
LoadedTriangles triangles_of(std::vector<PlainMesh> meshes, const std::string& path, std::vector<std::string>& warnings,
                             const std::stop_token& stop) {
    LoadedTriangles loaded;
    loaded.owner_names = names_of(meshes, path, stop);
    loaded.owner_details = details_of(meshes, loaded.owner_names, stop);
    CrossingFaces crossing;
    for (std::size_t owner = 0; owner < meshes.size(); ++owner) {
        meshes[owner].name = loaded.owner_names[owner];
        const shape::Mesh mesh = cut_into_triangles(std::move(meshes[owner]), crossing, stop);
        for (const auto& [a, b, c] : mesh.triangles) {
            loaded.triangles.push_back({mesh.vertices[a], mesh.vertices[b], mesh.vertices[c]});
            loaded.owners.push_back(std::uint32_t(owner));
            for (const Point3d& corner : loaded.triangles.back()) {
                for (const double coordinate : corner) (void)rounded(coordinate, path);
            }
        }
    }
    crossing.append_warning(path, warnings);
    return loaded;
}

Buffer<Box3f> boxes_of_triangles(const LoadedTriangles& loaded, const std::string& path) {
    Buffer<Box3f> boxes{loaded.triangles.size()};
    for (std::size_t i = 0; i < loaded.triangles.size(); ++i) {
        for (std::size_t axis = 0; axis < 3; ++axis) {
            std::array<float, 3> at;
            for (std::size_t k = 0; k < 3; ++k) at[k] = rounded(loaded.triangles[i][k][axis], path);
            boxes.data()[i].min[axis] = std::min({at[0], at[1], at[2]});
            boxes.data()[i].max[axis] = std::max({at[0], at[1], at[2]});
        }
    }
    return boxes;
}

}  // namespace

bool is_plain_ending(std::string_view ending) {
    return ending == ".obj" || ending == ".off" || ending == ".stl" || ending == ".ply";
}

LoadedScene read_plain_scene(const std::string& path, const SceneContent& content, const std::stop_token& stop) {
    LoadedScene scene;
    scene.root = std::filesystem::path(path).filename().string();
    std::vector<PlainMesh> meshes = read_meshes(path, stop, content.progress, scene);
    if (content.objects == MeshObjects::node) {
        add_objects(meshes, path, scene, stop);
        if (content.shapes) add_shapes(std::move(meshes), path, scene, stop);
        return scene;
    }
    LoadedTriangles loaded = triangles_of(std::move(meshes), path, scene.warnings, stop);
    scene.objects = loaded.triangles.size();
    if (content.shapes) {
        scene.triangles = std::move(loaded);
    } else {
        scene.boxes = boxes_of_triangles(loaded, path);
    }
    return scene;
}

shape::Mesh read_plain_mesh(const std::string& path, LoadedScene& scene, const std::stop_token& stop) {
    shape::Mesh whole;
    std::vector<PlainMesh> meshes = read_meshes(path, stop, {}, scene);
    const std::vector<std::string> names = names_of(meshes, path, stop);
    CrossingFaces crossing;
    for (std::size_t i = 0; i < meshes.size(); ++i) {
        meshes[i].name = names[i];
        const auto first = std::uint32_t(whole.vertices.size());
        const shape::Mesh part = cut_into_triangles(std::move(meshes[i]), crossing, stop);
        whole.vertices.insert(whole.vertices.end(), part.vertices.begin(), part.vertices.end());
        for (const auto& [a, b, c] : part.triangles) whole.triangles.push_back({a + first, b + first, c + first});
    }
    crossing.append_warning(path, scene.warnings);
    return whole;
}

}  // namespace octopair::io
