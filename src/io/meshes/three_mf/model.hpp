// Model: the start part of a 3MF file and the parts that it refers to, with all references resolved.
//
// - All parts have the same unit.
// - No object contains itself: objects refer to objects before them, and only the start part refers to other parts.
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <functional>
#include <string>
#include <unordered_map>
#include <utility>
#include <vector>

#include "io/meshes/three_mf/model_part.hpp"
#include "io/meshes/three_mf/package.hpp"

namespace octopair::io::three_mf {

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
    /// Returns the mesh of an object, without its vertices and triangles afterwards.
    SharedMesh take_mesh(const ObjectPlace& place) { return std::move(parts_[place.part].objects[place.number].mesh); }
    /// Returns "FILE: PART: line N".
    std::string place_of(std::size_t part, std::uint64_t line) const;
    /// Returns what a user should know about the parts, each one line "FILE: ...".
    std::vector<std::string> warnings() const;

private:
    void add_parts(const std::vector<Reference>& references, const std::function<void(double)>& progress);
    void add_part(const Reference& from, const std::function<void(double)>& progress);
    void resolve(std::vector<Reference>& references, std::size_t part);

    Package& package_;
    std::deque<ModelPart> parts_;                                // a part keeps its place when others are added
    std::unordered_map<std::string, std::size_t> part_numbers_;  // name, as the references have it -> index in parts_
};

}  // namespace octopair::io::three_mf
