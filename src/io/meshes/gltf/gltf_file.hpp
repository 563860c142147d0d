// GltfFile: a glTF 2.0 file in memory, as text or as GLB: its JSON and its buffers.
//
// - The first bytes show whether a file is GLB, not its ending.
// - A buffer is read when it is first used: from base64 in its URI, from the chunk of a GLB file, or from another file. The name
//   of another file is relative to the folder of the glTF file. URIs with a scheme, such as http, and absolute names are refused.
//
// Source: Khronos, glTF 2.0 specification, sections 3 (JSON, buffers) and 4 (GLB).
//
// Extensions that a file may require:
//
//   geometry     KHR_mesh_quantization, EXT_mesh_gpu_instancing: read.
//   no geometry  materials, textures, lights, metadata: accepted and not read.
//   by Assimp    KHR_draco_mesh_compression: Assimp reads the file.
//   others       refused by name, because the geometry may be in the extension.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <span>
#include <stop_token>
#include <string>
#include <string_view>

#include <nlohmann/json.hpp>

#include "base/memory.hpp"
#include "io/files/input_file.hpp"
#include "io/json/json_fields.hpp"
#include "io/meshes/read_budget.hpp"

namespace octopair::io::gltf {

/// A range of bytes of a buffer.
struct BufferView {
    std::span<const std::byte> bytes;
    std::uint64_t stride;  ///< bytes from one element to the next; 0 if elements follow without gaps
    std::string name;      ///< for messages, for example "bufferViews[3]"
};

class GltfFile {
public:
    /// Reads a file without its buffers.
    /// Throws: Error{bad_input} for a file that is cut, or whose JSON is wrong; Error{io_failed, cancelled}.
    GltfFile(const std::string& path, const std::stop_token& stop);
    /// Like the constructor above, with the content of the file.
    GltfFile(std::string path, Buffer<std::byte> content, const std::stop_token& stop);

    const std::string& path() const { return budget_.path(); }
    /// Returns the version of glTF, for example "2.0".
    const std::string& version() const { return version_; }
    const nlohmann::json& root() const { return root_; }
    /// Returns the root as fields with the place "FILE".
    JsonFields fields() const { return {root_, path()}; }

    /// Returns the number of objects in an array of the root, for example "meshes"; 0 if the root does not have it.
    std::size_t count(std::string_view list) const;
    /// Returns an object of an array of the root. Its place is "FILE: meshes[3]".
    /// Throws: Error{bad_input} if there is no such object.
    JsonFields item(std::string_view list, std::uint64_t number) const;
    /// Returns a buffer view. Borrows the bytes from this object.
    /// Throws: Error{bad_input} if it is not inside its buffer, or the buffer cannot be read; Error{io_failed, cancelled}.
    BufferView view(std::uint64_t number);

    /// Returns the limits for reading. All files that the glTF file names count towards them.
    ReadBudget& budget() { return budget_; }
    /// Calls ReadBudget::charge().
    void charge(std::uint64_t count, std::uint64_t bytes) { budget_.charge(count, bytes); }
    /// Calls ReadBudget::checkpoint().
    void checkpoint() const { budget_.checkpoint(); }
    const std::stop_token& stop() const { return budget_.stop(); }

private:
    void split_glb();
    void parse(std::span<const std::byte> text);
    std::span<const std::byte> buffer(std::uint64_t number);
    std::span<const std::byte> bytes_of(const JsonFields& buffer, std::uint64_t number);
    Buffer<std::byte> embedded(const JsonFields& buffer, std::string_view uri) const;
    Buffer<std::byte> other_file(const JsonFields& buffer, std::string_view uri) const;

    ReadBudget budget_;
    Buffer<std::byte> content_;
    std::span<const std::byte> binary_chunk_;  // buffers in a GLB file
    nlohmann::json root_;
    std::string version_;
    std::map<std::uint64_t, Buffer<std::byte>> buffers_;  // buffers that are not in the chunk
};

/// Returns whether a file may need Assimp: it is of glTF 1.0, or has meshes that are compressed with Draco. Only searches the text, so
/// the result may also be true for other files. Returns false if the file cannot be read.
bool may_need_assimp(const std::string& path);

/// Name of the extension that places many copies of a node.
inline constexpr const char* instancing = "EXT_mesh_gpu_instancing";

/// Name of the extension that says which nodes are shown.
inline constexpr const char* visibility = "KHR_node_visibility";

/// Throws: Error{bad_input} that names an extension that the file requires, and that octopair does not read.
void check_required_extensions(const GltfFile& file);

/// Returns whether Assimp must read a file: it has compressed meshes without a copy that is not compressed.
/// Throws: Error{bad_input} if such a file also uses extensions that Assimp ignores.
bool needs_assimp(const GltfFile& file);

}  // namespace octopair::io::gltf
