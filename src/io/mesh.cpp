#include "io/mesh.hpp"

#include <algorithm>
#include <cmath>
#include <exception>
#include <limits>
#include <new>

#include <assimp/postprocess.h>
#include <assimp/scene.h>
#include <fmt/format.h>
#include <assimp/Importer.hpp>

#include "io/failure.hpp"
#include "io/input_file.hpp"
#include "io/pose.hpp"

namespace octopair::io {

namespace {

/// A node that shows meshes, with the path to it.
struct Instance {
    const aiNode* node;
    std::string name;
    Pose pose;
};

/// Importers turn what they throw into an error text; want of memory is told apart again.
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

const aiScene& import(Assimp::Importer& importer, const std::string& path, unsigned steps) {
    const InputFile readable(path);  // for the system's own words where it is not
    const aiScene* scene = importer.ReadFile(path, steps);
    if (scene != nullptr && scene->mRootNode != nullptr) return *scene;
    rethrow_bad_alloc(importer);
    std::string words = importer.GetErrorString();
    std::replace_if(
        words.begin(), words.end(), [](char c) { return c >= 0 && c < ' '; }, ' ');
    refuse(path,
           words.empty() ? std::string("Assimp finds no scene in it") : fmt::format("Assimp refuses it: {}", words));
}

Pose pose_of(const aiNode& node) {
    const aiMatrix4x4& m = node.mTransformation;
    return Pose({{{m.a1, m.a2, m.a3, m.a4}, {m.b1, m.b2, m.b3, m.b4}, {m.c1, m.c2, m.c3, m.c4}}});
}

std::string name_of(const aiNode& node, unsigned position) {
    return node.mName.length == 0 ? fmt::format("#{}", position) : std::string(node.mName.C_Str());
}

/// All instances, in pre-order. The nodes are walked with a stack of our own: files choose how deep they are.
std::vector<Instance> find_instances(const aiScene& scene) {
    std::vector<Instance> instances;
    std::vector<Instance> waiting;
    waiting.push_back({scene.mRootNode, name_of(*scene.mRootNode, 0), pose_of(*scene.mRootNode)});
    while (!waiting.empty()) {
        const Instance at = std::move(waiting.back());
        waiting.pop_back();
        for (unsigned i = at.node->mNumChildren; i-- > 0;) {
            const aiNode& child = *at.node->mChildren[i];
            waiting.push_back({&child, at.name + '/' + name_of(child, i), at.pose * pose_of(child)});
        }
        if (at.node->mNumMeshes > 0) instances.push_back(at);
    }
    return instances;
}

class MeshReader {
public:
    MeshReader(const aiScene& scene, std::string_view file) : scene_(scene), file_(file) {}

    LoadedScene nodes() const {
        std::vector<Box3d> boxes;
        LoadedScene loaded;
        for (const Instance& instance : find_instances(scene_)) {
            const Box3d box = node_box(instance);
            if (box.min[0] > box.max[0]) continue;  // a node without vertices shows nothing
            boxes.push_back(box);
            loaded.names.push_back(instance.name);
        }
        loaded.objects = boxes.size();
        loaded.boxes = copy_of(boxes);
        return loaded;
    }

    LoadedScene triangles() const {
        std::vector<Box3f> boxes;
        for (const Instance& instance : find_instances(scene_)) {
            for (unsigned i = 0; i < instance.node->mNumMeshes; ++i) {
                append_triangles(mesh_of(instance, i), instance, boxes);
            }
        }
        LoadedScene loaded;
        loaded.objects = boxes.size();
        loaded.boxes = copy_of(boxes);
        return loaded;
    }

private:
    template <typename T>
    static Buffer<T> copy_of(const std::vector<T>& boxes) {
        Buffer<T> copy{boxes.size()};
        std::copy(boxes.begin(), boxes.end(), copy.data());
        return copy;
    }

    const aiMesh& mesh_of(const Instance& instance, unsigned i) const {
        return *scene_.mMeshes[instance.node->mMeshes[i]];
    }

    Box3d node_box(const Instance& instance) const {
        constexpr double infinity = std::numeric_limits<double>::infinity();
        Box3d box{{infinity, infinity, infinity}, {-infinity, -infinity, -infinity}};
        for (unsigned i = 0; i < instance.node->mNumMeshes; ++i) {
            const aiMesh& mesh = mesh_of(instance, i);
            for (unsigned f = 0; f < mesh.mNumFaces; ++f) {
                for (unsigned k = 0; k < mesh.mFaces[f].mNumIndices; ++k) {
                    grow(box, posed_vertex(mesh, mesh.mFaces[f].mIndices[k], instance));
                }
            }
            for (unsigned v = 0; mesh.mNumFaces == 0 && v < mesh.mNumVertices; ++v) {
                grow(box, posed_vertex(mesh, v, instance));
            }
        }
        return box;
    }

    static void grow(Box3d& box, const BoundedPoint& point) {
        for (int axis = 0; axis < 3; ++axis) {
            box.min[axis] = std::min(box.min[axis], point.low[axis]);
            box.max[axis] = std::max(box.max[axis], point.high[axis]);
        }
    }

    void append_triangles(const aiMesh& mesh, const Instance& instance, std::vector<Box3f>& boxes) const {
        for (unsigned f = 0; f < mesh.mNumFaces; ++f) {
            const aiFace& face = mesh.mFaces[f];
            if (face.mNumIndices != 3) continue;
            Box3f box;
            for (unsigned k = 0; k < 3; ++k) {
                const BoundedPoint point = posed_vertex(mesh, face.mIndices[k], instance);
                for (int axis = 0; axis < 3; ++axis) {
                    const float value = float(point.value[axis]);
                    if (!std::isfinite(value)) refuse_vertex(instance, face.mIndices[k], double(value));
                    box.min[axis] = k == 0 ? value : std::min(box.min[axis], value);
                    box.max[axis] = k == 0 ? value : std::max(box.max[axis], value);
                }
            }
            boxes.push_back(box);
        }
    }

    BoundedPoint posed_vertex(const aiMesh& mesh, unsigned index, const Instance& instance) const {
        if (index >= mesh.mNumVertices) {
            refuse(file_,
                   fmt::format("node '{}': a face names vertex {} of {}", instance.name, index, mesh.mNumVertices));
        }
        const aiVector3D& vertex = mesh.mVertices[index];
        const std::array<double, 3> place = {double(vertex.x), double(vertex.y), double(vertex.z)};
        const BoundedPoint point = instance.pose.apply(place);
        for (const auto& numbers : {place, point.low, point.high}) {
            for (const double number : numbers) {
                if (!std::isfinite(number)) refuse_vertex(instance, index, number);
            }
        }
        return point;
    }

    [[noreturn]] void refuse_vertex(const Instance& instance, unsigned index, double value) const {
        refuse(file_, fmt::format("node '{}': vertex {} is at {}, not at a finite place", instance.name, index,
                                  number_text(value)));
    }

    const aiScene& scene_;
    std::string_view file_;
};

}  // namespace

bool is_mesh_ending(std::string_view ending) {
    return ending.size() > 1 && Assimp::Importer().IsExtensionSupported(std::string(ending));
}

LoadedScene read_mesh_scene(const std::string& path, MeshObjects objects) {
    Assimp::Importer importer;
    const bool by_triangle = objects == MeshObjects::triangle;
    const aiScene& scene = import(importer, path, by_triangle ? unsigned(aiProcess_Triangulate) : 0u);
    const MeshReader reader(scene, path);
    return by_triangle ? reader.triangles() : reader.nodes();
}

}  // namespace octopair::io
