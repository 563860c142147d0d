#include "io/meshes/mesh_file.hpp"

#include <algorithm>
#include <cmath>
#include <exception>
#include <new>
#include <numeric>

#include <assimp/postprocess.h>
#include <fmt/format.h>

#include "io/files/failure.hpp"
#include "io/files/input_file.hpp"

namespace octopair::io {

namespace {

/// Throws std::bad_alloc again if Assimp caught it. Assimp turns every exception into an error text.
void rethrow_bad_alloc(const Assimp::Importer& importer) {
    const std::exception_ptr& exception = importer.GetException();
    if (!exception) return;
    try {
        std::rethrow_exception(exception);
    } catch (const std::bad_alloc&) {
        throw;
    } catch (...) {
        return;
    }
}

BoundedPose pose_of(const aiNode& node) {
    const aiMatrix4x4& m = node.mTransformation;
    return BoundedPose({{{m.a1, m.a2, m.a3, m.a4}, {m.b1, m.b2, m.b3, m.b4}, {m.c1, m.c2, m.c3, m.c4}}});
}

std::string name_of(const aiNode& node, unsigned position) {
    return node.mName.length == 0 ? fmt::format("#{}", position) : std::string(node.mName.C_Str());
}

/// Returns all nodes with meshes, in pre-order. The traversal has an explicit stack, because the file controls the depth.
std::vector<MeshInstance> find_instances(const aiScene& scene) {
    std::vector<MeshInstance> instances;
    std::vector<MeshInstance> waiting;
    waiting.push_back({scene.mRootNode, name_of(*scene.mRootNode, 0), pose_of(*scene.mRootNode)});
    while (!waiting.empty()) {
        const MeshInstance at = std::move(waiting.back());
        waiting.pop_back();
        for (unsigned i = at.node->mNumChildren; i-- > 0;) {
            const aiNode& child = *at.node->mChildren[i];
            waiting.push_back({&child, at.name + '/' + name_of(child, i), at.pose * pose_of(child)});
        }
        if (at.node->mNumMeshes > 0) instances.push_back(at);
    }
    return instances;
}

}  // namespace

MeshFile::MeshFile(const std::string& path, bool triangles) : path_(path), scene_(&import(path, triangles)) {
    used_vertices_.resize(scene_->mNumMeshes);
    instances_ = find_instances(*scene_);
    std::erase_if(instances_, [this](const MeshInstance& instance) { return !has_vertices(instance); });
}

const aiScene& MeshFile::import(const std::string& path, bool triangles) {
    const InputFile readable(path);  // throws an error with the reason of the system if the file cannot be opened
    const aiScene* scene = importer_.ReadFile(path, triangles ? unsigned(aiProcess_Triangulate) : 0u);
    if (scene != nullptr && scene->mRootNode != nullptr) return *scene;
    rethrow_bad_alloc(importer_);
    std::string words = importer_.GetErrorString();
    std::replace_if(
        words.begin(), words.end(), [](char c) { return c >= 0 && c < ' '; }, ' ');
    refuse(path,
           words.empty() ? std::string("Assimp finds no scene in it") : fmt::format("Assimp refuses it: {}", words));
}

bool MeshFile::has_vertices(const MeshInstance& instance) {
    bool something = false;
    for (const unsigned number : instance.meshes()) {
        if (!used_vertices_[number]) used_vertices_[number] = find_used_vertices(instance, mesh(number));
        something |= !used_vertices_[number]->empty();
    }
    return something;
}

std::vector<unsigned> MeshFile::find_used_vertices(const MeshInstance& instance, const aiMesh& mesh) const {
    std::vector<unsigned> shown;
    if (mesh.mNumFaces == 0) {
        shown.resize(mesh.mNumVertices);
        std::iota(shown.begin(), shown.end(), 0u);
        return shown;
    }
    std::vector<bool> seen(mesh.mNumVertices);
    for (const aiFace& face : std::span(mesh.mFaces, mesh.mNumFaces)) {
        for (const unsigned index : std::span(face.mIndices, face.mNumIndices)) {
            if (index >= mesh.mNumVertices) {
                refuse(path_, fmt::format("node '{}': a face refers to vertex {}, but the mesh has {} vertices",
                                          instance.name, index, mesh.mNumVertices));
            }
            if (!seen[index]) shown.push_back(index);
            seen[index] = true;
        }
    }
    return shown;
}

BoundedPoint MeshFile::posed_vertex(const MeshInstance& instance, const aiMesh& mesh, unsigned index) const {
    const Point3d place = vertex(mesh, index);
    const BoundedPoint point = instance.pose.apply(place);
    for (const auto& numbers : {place, point.low, point.high}) {
        for (const double number : numbers) {
            if (!std::isfinite(number)) refuse_vertex(instance, index, number);
        }
    }
    return point;
}

void MeshFile::refuse_vertex(const MeshInstance& instance, unsigned index, double value) const {
    refuse(path_, fmt::format("node '{}': vertex {} has the coordinate {}, which is not finite", instance.name, index,
                              number_text(value)));
}

}  // namespace octopair::io
