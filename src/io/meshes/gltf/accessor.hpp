// Accessor: an array of numbers of a glTF file, with every way that glTF has to store it.
//
//   numbers   of all types. Normalised integers become float64 as the specification says: for example c / 127, and at least -1.
//   stride    elements with gaps between them
//   sparse    some elements replace those of the array
//   no data   an accessor without a buffer view has zeros
//
// The constructor checks that all elements are inside their buffer views. Values are decoded when they are used.
//
// Source: Khronos, glTF 2.0 specification, section 3.6.2; KHR_mesh_quantization for integers as positions.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "io/meshes/gltf/gltf_file.hpp"

namespace octopair::io::gltf {

class Accessor {
public:
    /// `components`: the numbers that an element must have, 1 to 4.
    /// Throws: Error{bad_input} that names the accessor; what GltfFile::view() throws.
    Accessor(GltfFile& file, std::uint64_t number, unsigned components);

    /// Returns the number of elements.
    std::uint64_t count() const { return count_; }
    bool is_float() const { return type_ == Type::float32; }
    /// Returns the distance between neighbouring values that the type of integers can have. Requires: !is_float().
    double step() const;
    /// Returns the place of the accessor, for messages.
    const std::string& place() const { return place_; }

    /// Returns an element. Requires: `index` < count(); n is the number of components.
    template <std::size_t n>
    std::array<double, n> at(std::uint64_t index) const {
        std::array<double, n> element{};
        const std::byte* const bytes = element_bytes(index);
        if (bytes == nullptr) return element;
        for (std::size_t i = 0; i < n; ++i) element[i] = number(bytes + i * component_bytes());
        return element;
    }
    /// Returns an element of an array of vertex indices. Requires: `index` < count(); the accessor passed check_indices().
    std::uint32_t index_at(std::uint64_t index) const;

    /// Throws: Error{bad_input} if the numbers are not unsigned integers.
    void check_indices() const;
    /// Returns the largest number that the type of the indices can have. Requires: the accessor passed check_indices().
    std::uint32_t largest_index() const;

private:
    enum class Type : std::uint16_t { int8 = 5120, uint8, int16, uint16, uint32 = 5125, float32 };

    void read_type(const JsonFields& fields);
    void read_sparse(GltfFile& file, const JsonFields& sparse);
    /// Returns the first of `count` elements in a view, and checks that all are inside the view. Sets `stride` to the stride of the view.
    const std::byte* elements_in(GltfFile& file, const JsonFields& fields, std::uint64_t& stride) const;
    const std::byte* element_bytes(std::uint64_t index) const;
    double number(const std::byte* bytes) const;
    std::uint64_t component_bytes() const;

    std::string place_;
    Type type_ = Type::float32;
    bool normalized_ = false;
    unsigned components_;
    std::uint64_t count_ = 0;
    const std::byte* base_ = nullptr;  // null: all elements are zeros
    std::uint64_t stride_ = 0;
    std::vector<std::uint64_t> replaced_;  // ascending indices of the elements that `replacements_` replace
    const std::byte* replacements_ = nullptr;
};

}  // namespace octopair::io::gltf
