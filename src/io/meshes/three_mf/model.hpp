// Model: the start part of a 3MF file and the parts that it refers to, with all references resolved. ModelPart: the content of one
// part: its objects, and the items to build.
//
// - Numbers are the nearest float64. Vertices that no triangle uses are left out.
// - All indices of vertices exist. An object refers only to objects before it in the same part, or to objects of other parts.
// - All parts have the same unit.
// - No object contains itself: objects refer to objects before them, and only the start part refers to other parts.
//
// Source: 3MF Consortium, core specification 1.3, chapters 3 to 5; production extension 1.1.
#pragma once

#include <compare>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <functional>
#include <string>
#include <string_view>
#include <unordered_map>
#include <utility>
#include <vector>

#include "io/meshes/placed_meshes.hpp"
#include "io/meshes/three_mf/package.hpp"
#include "octopair/pose.hpp"

namespace octopair::io::three_mf {

/// Place of an object: the index of its part in Model::parts(), and its index in ModelPart::objects.
struct ObjectPlace {
    std::size_t part = 0, number = 0;

    auto operator<=>(const ObjectPlace&) const = default;
};

/// A reference to an object, with a pose: a component of an object, or an item of the build.
struct Reference {
    std::uint32_t object = 0;  ///< identifier of the object
    std::string part;          ///< name of the part of the object; empty: the same part
    Pose pose;
    std::string part_number;  ///< part number of an item
    std::uint64_t line = 0;
    ObjectPlace target;  ///< place of the object; set by Model
};

enum class ObjectType : std::uint8_t { model, support, solidsupport, surface, other };

struct ModelObject {
    std::uint32_t id = 0;
    std::string name, part_number;
    ObjectType type = ObjectType::model;
    bool is_coarse = false;  ///< the mesh replaces a finer shape, which other data describe
    bool has_mesh = false, has_components = false;
    std::string extension;  ///< first element of an extension that may change the shape; empty if there is none
    SharedMesh mesh;        ///< valid if has_mesh
    std::vector<Reference> components;
    std::uint64_t line = 0;
};

/// Number of problems of one kind, and the place of the first problem.
struct CountedNote {
    std::uint64_t count = 0;
    std::string first;
};

struct ModelPart {
    std::string name;     ///< name of the part, for example "3D/3dmodel.model"
    std::string version;  ///< version of the namespace, for example "2015/02"; empty if the part has none
    std::string unit;     ///< unit as the file writes it, for example "millimeter"
    bool needs_slices = false;
    std::vector<ModelObject> objects;
    std::unordered_map<std::uint32_t, std::size_t> numbers;  ///< identifier of an object -> index in `objects`
    std::vector<Reference> items;
    CountedNote flat_triangles;     ///< triangles with two equal vertices
    CountedNote unknown_elements;   ///< elements that 3MF does not define
    CountedNote unknown_materials;  ///< references to materials that do not exist
};

/// Says how to read a part.
struct PartReading {
    bool is_root = true;  ///< true: the part has the items to build, and may refer to other parts
    ReadBudget& budget;
};

/// Parses a part. `name`: name of the part.
/// Throws: Error{bad_input} "FILE: NAME: line N: ..."; Error{resource_limit, cancelled}; what the source throws.
ModelPart parse_model_part(std::string name, const TextSource& source, const PartReading& reading);

/// Returns the version of the namespace of a part. Reads only its first element. Throws: as parse_model_part().
std::string parse_version(const std::string& name, const TextSource& source, ReadBudget& budget);

class Model {
public:
    /// Reads all parts. Borrows the package. `progress`: called with the part of the file that is read; or empty.
    /// Throws: Error{bad_input} that names the part and the line, if a reference has no object, or a part has another unit;
    /// Error{resource_limit, cancelled}; what parse_model_part() throws.
    Model(Package& package, const std::function<void(double)>& progress);

    ReadBudget& budget() const { return package_.budget(); }
    const std::string& path() const { return package_.budget().path(); }
    /// Returns the parts. The first one is the start part.
    const std::deque<ModelPart>& parts() const { return parts_; }
    const ModelPart& start() const { return parts_.front(); }
    const ModelObject& object(const ObjectPlace& place) const { return parts_[place.part].objects[place.number]; }
    /// Returns the mesh of an object, and removes it from the object.
    SharedMesh take_mesh(const ObjectPlace& place) { return std::move(parts_[place.part].objects[place.number].mesh); }
    /// Returns "FILE: PART: line N".
    std::string place_of(std::size_t part, std::uint64_t line) const;
    /// Returns warnings for the user about the parts, each one line "FILE: ...".
    std::vector<std::string> warnings() const;

private:
    void add_parts(const std::vector<Reference>& references, const std::function<void(double)>& progress);
    void add_part(const Reference& from, const std::function<void(double)>& progress);
    void resolve(std::vector<Reference>& references, std::size_t part);

    Package& package_;
    std::deque<ModelPart> parts_;                                // a deque: parts keep their addresses
    std::unordered_map<std::string, std::size_t> part_numbers_;  // name in references -> index in parts_
};

}  // namespace octopair::io::three_mf
