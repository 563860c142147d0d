#include "io/meshes/assimp/mesh_file.hpp"

#include <algorithm>
#include <cmath>
#include <exception>
#include <filesystem>
#include <new>
#include <numeric>

#include <assimp/DefaultIOSystem.h>
#include <assimp/MemoryIOWrapper.h>
#include <fmt/format.h>

#include "base/memory.hpp"
#include "io/files/failure.hpp"
#include "io/files/input_file.hpp"
#include "io/formats/content_marks.hpp"
#include "io/formats/format_choice.hpp"
#include "io/meshes/assimp/ifc_text.hpp"
#include "io/meshes/faces/face_cutter.hpp"

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

/// Returns the largest absolute coordinate of a node's translation.
double translation_of(const aiNode& node) {
    const aiMatrix4x4& m = node.mTransformation;
    return std::max({std::abs(double(m.a4)), std::abs(double(m.b4)), std::abs(double(m.c4))});
}

Buffer<char> read_bytes(const InputFile& file) {
    Buffer<char> bytes{std::size_t(file.size())};
    file.read(0, std::as_writable_bytes(bytes.span()));
    return bytes;
}

/// Returns the facts that the text of an IFC file states. Empty for compressed files and other formats.
/// Throws: Error{bad_input} if the file is cut. Assimp would read the part before the cut without an error.
IfcText read_text_of_ifc(const std::string& path, const KnownFormat& known) {
    if (known.ending != ".ifc") return {};
    const Buffer<char> text = read_bytes(InputFile(path));
    IfcText read = read_ifc_text({text.data(), text.size()});
    if (!read.complete) refuse(path, "is cut: an IFC file ends with END-ISO-10303-21;");
    return read;
}

/// The system's files for Assimp. Only the file at `path` has another content: `text`.
class FilesWithText : public Assimp::DefaultIOSystem {
public:
    /// Requires: `text` outlives this object.
    FilesWithText(std::string path, const std::string& text) : path_(std::move(path)), text_(text) {}

    Assimp::IOStream* Open(const char* file, const char* mode) override {
        if (file != path_) return DefaultIOSystem::Open(file, mode);
        return new Assimp::MemoryIOStream(reinterpret_cast<const std::uint8_t*>(text_.data()), text_.size());
    }

private:
    std::string path_;
    const std::string& text_;
};

/// Returns what to do about a file that Assimp refuses, as far as its content shows.
std::string remedy_for(const InputFile& file) {
    std::string begin(std::size_t(std::min<std::uint64_t>(file.size(), 4)), '\0');
    file.read(0, std::as_writable_bytes(std::span(begin)));
    const std::string_view encoding = wide_encoding(begin);
    if (!encoding.empty()) return fmt::format("it is text in {}; save it as UTF-8", encoding);
    return ifc_remedy(file.path());
}

/// Lists the instances of a scene.
class InstanceSearch {
public:
    InstanceSearch(const aiScene& scene, const MeshFile& file) : scene_(scene), file_(file) {}

    /// Returns all nodes with meshes, in pre-order. The traversal has an explicit stack, because the file controls the depth.
    std::vector<MeshInstance> find() const {
        std::vector<MeshInstance> instances;
        std::vector<MeshInstance> waiting;
        const aiNode& root = *scene_.mRootNode;
        waiting.push_back({&root, name_of(root, 0), file_.world_pose(), file_.unit_change()(translation_of(root))});
        while (!waiting.empty()) {
            const MeshInstance at = std::move(waiting.back());
            waiting.pop_back();
            for (unsigned i = at.node->mNumChildren; i-- > 0;) {
                if (at.node->mChildren[i] == nullptr)
                    refuse(file_.path(), "has a node that its importer could not read");
                const aiNode& child = *at.node->mChildren[i];
                waiting.push_back({&child, at.name + '/' + name_of(child, i), at.pose * pose_of(child),
                                   at.translations + at.pose.largest_scale() * translation_of(child)});
            }
            if (at.node->mNumMeshes > 0) instances.push_back(at);
        }
        return instances;
    }

private:
    std::string name_of(const aiNode& node, unsigned position) const {
        if (node.mName.length == 0) return fmt::format("#{}", position);
        std::string name = node.mName.C_Str();
        const IfcTexts& ifc_names = file_.ifc_text().names;
        if (ifc_names.empty()) return name;
        const auto element = parse_ifc_element(name);
        if (!element) return name;
        const auto known = ifc_names.find(std::string(element->id));
        if (known == ifc_names.end()) return name;
        return fmt::format("{}_{}_{}", element->type, known->second, element->id);
    }

    const aiScene& scene_;
    const MeshFile& file_;
};

}  // namespace

MeshFile::MeshFile(const std::string& path, bool triangles, std::string_view unit)
    : path_(path),
      known_(known_format(path)),
      ifc_text_(read_text_of_ifc(path, known_)),
      content_(check_mesh_content(path, known_)),
      scene_(&import(path)),
      change_(space().unit, unit) {
    used_vertices_.resize(scene_->mNumMeshes);
    instances_ = InstanceSearch(*scene_, *this).find();
    std::erase_if(instances_, [this](const MeshInstance& instance) { return !has_vertices(instance); });
    cut_meshes_.resize(scene_->mNumMeshes);
    if (triangles) cut_faces();
}

const aiScene& MeshFile::import(const std::string& path) {
    const InputFile readable(path);  // throws an error with the reason of the system if the file cannot be opened
    // Assimp chooses its reader by the ending. A file with a wrong or missing ending is read from memory, under the right ending.
    importer_.SetPropertyBool(AI_CONFIG_IMPORT_NO_SKELETON_MESHES, true);  // no file has such meshes
    const bool by_name = !known_.by_content && content_.ending.empty();
    const aiScene* const scene = by_name ? import_by_name(path) : import_by_content(readable);
    readable.check_unchanged();
    if (scene != nullptr && scene->mRootNode != nullptr) {
        // Some importers name the root by the path, and an object's name must not depend on the folder.
        aiNode& root = *scene->mRootNode;
        if (root.mName.C_Str() == path) root.mName.Set(std::filesystem::path(path).filename().string());
        return *scene;
    }
    rethrow_bad_alloc(importer_);
    std::string words = importer_.GetErrorString();
    std::replace_if(
        words.begin(), words.end(), [](char c) { return c >= 0 && c < ' '; }, ' ');
    std::string reason =
        words.empty() ? std::string("Assimp finds no scene in it") : fmt::format("Assimp refuses it: {}", words);
    if (const std::string remedy = remedy_for(readable); !remedy.empty()) reason += "; " + remedy;
    refuse(path, reason);
}

const aiScene* MeshFile::import_by_name(const std::string& path) {
    if (content_.text) importer_.SetIOHandler(new FilesWithText(path, *content_.text));
    return importer_.ReadFile(path, 0u);
}

const aiScene* MeshFile::import_by_content(const InputFile& file) {
    const char* const ending = (content_.ending.empty() ? known_.ending : content_.ending).c_str() + 1;
    if (content_.text) return importer_.ReadFileFromMemory(content_.text->data(), content_.text->size(), 0u, ending);
    const Buffer<char> bytes = read_bytes(file);
    return importer_.ReadFileFromMemory(bytes.data(), bytes.size(), 0u, ending);
}

/// Cuts the faces of all meshes that have faces with more than three corners.
void MeshFile::cut_faces() {
    const std::stop_token never;
    FaceCutter cutter(never);
    std::vector<Point3d> places;
    for (const MeshInstance& instance : instances_) {
        for (const unsigned number : instance.meshes()) {
            const std::span faces(mesh(number).mFaces, mesh(number).mNumFaces);
            const auto has_more_corners = [](const aiFace& face) { return face.mNumIndices > 3; };
            if (cut_meshes_[number] || std::none_of(faces.begin(), faces.end(), has_more_corners)) continue;
            auto& triangles = cut_meshes_[number].emplace();
            for (const aiFace& face : faces) {
                places.clear();
                for (const unsigned index : std::span(face.mIndices, face.mNumIndices)) {
                    for (const double coordinate : places.emplace_back(vertex(mesh(number), index))) {
                        if (!std::isfinite(coordinate)) refuse_vertex(instance, index, coordinate);
                    }
                }
                if (!cutter.cut(places)) crossing_faces_.add(std::uint64_t(&face - faces.data()), instance.name);
                for (const auto& [a, b, c] : cutter.triangles())
                    triangles.push_back({face.mIndices[a], face.mIndices[b], face.mIndices[c]});
            }
        }
    }
}

BoundedPose MeshFile::world_pose() const {
    const BoundedPose root = root_pose(*scene_->mRootNode, known_);
    if (change_.is_none()) return root;
    const double factor = change_.factor();
    return BoundedPose({{{factor, 0, 0, 0}, {0, factor, 0, 0}, {0, 0, factor, 0}}}) * root;
}

double MeshFile::largest_rounded() const {
    double largest = world_pose().largest_scale() * ifc_text_.largest_coordinate;
    for (const MeshInstance& instance : instances_) {
        double vertex_size = 0;
        for (const unsigned number : instance.meshes()) {
            for (const unsigned index : used_vertices(number)) {
                for (const double coordinate : vertex(mesh(number), index))
                    vertex_size = std::max(vertex_size, std::abs(coordinate));
            }
        }
        largest = std::max(largest, instance.translations + instance.pose.largest_scale() * vertex_size);
    }
    return largest;
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
