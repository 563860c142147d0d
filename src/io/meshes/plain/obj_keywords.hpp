// The keywords of OBJ files: those of Wavefront's specification, with the superseded ones.
#pragma once

#include <cstdint>
#include <string_view>

namespace octopair::io {

/// Meaning of a line of an OBJ file.
enum class ObjKeyword : std::uint8_t {
    vertex,
    face,
    line,    ///< a polyline
    points,  ///< any number of points
    material,
    object,
    group,
    ignored,   ///< says nothing about geometry
    freeform,  ///< curves and surfaces, which are not read
    call,      ///< another file, which is not read
    unknown,
};

/// Returns the meaning of the first word of a line. Requires: letters are small.
ObjKeyword obj_keyword(std::string_view word);

}  // namespace octopair::io
