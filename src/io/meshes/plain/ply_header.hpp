// The header of PLY files: the encoding, and the elements in their order, with their properties.
//
// The lines of the header end with LF, CR LF or CR, all in the same way. The elements of a binary file begin right after the last line.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "io/meshes/plain/text_lines.hpp"

namespace octopair::io {

enum class PlyEncoding : std::uint8_t { text, little_endian, big_endian };

/// A type of numbers.
struct PlyScalar {
    unsigned bytes = 0;
    enum class Kind : std::uint8_t { integer, unsigned_integer, real } kind = Kind::integer;
};

struct PlyProperty {
    std::string name;
    PlyScalar value;                 ///< type of the value, or of the values of a list
    std::optional<PlyScalar> count;  ///< type of the length of a list
};

struct PlyElement {
    std::string name;
    std::uint64_t count = 0;
    std::vector<PlyProperty> properties;

    /// Returns the least number of bytes of one element, in a binary file.
    std::uint64_t least_bytes() const {
        std::uint64_t bytes = 0;
        for (const PlyProperty& property : properties)
            bytes += property.count ? property.count->bytes : property.value.bytes;
        return bytes;
    }
};

struct PlyHeader {
    PlyEncoding encoding = PlyEncoding::text;
    std::vector<PlyElement> elements;

    /// Returns the number of vertices, which the header may list after the faces.
    std::uint64_t vertices() const {
        std::uint64_t count = 0;
        for (const PlyElement& element : elements) count += element.name == "vertex" ? element.count : 0;
        return count;
    }
};

/// Reads the header of a file, from its first line to "end_header". Throws: Error{bad_input} with the line.
PlyHeader read_ply_header(TextLines& lines);

}  // namespace octopair::io
