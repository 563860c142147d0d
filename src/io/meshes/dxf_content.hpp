// Finds in the text of a DXF file what Assimp reads wrongly or leaves out.
//
// Assimp 5.2 reads 3DFACE, LINE and POLYLINE, and blocks that the section ENTITIES inserts. These are its faults:
//
// - An INSERT is not rotated. Its position is scaled, too. Rows, columns and a direction of extrusion are ignored.
// - A point of an unknown entity in a block becomes the base of the block. A name in such an entity becomes that of the block.
// - An INSERT within a block, and everything after it in the block, is left out.
// - A corner of a polyface mesh is left out if the edge after it is invisible (a negative index). Meshes of M x N points are read as lines.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace octopair::io {

struct DxfFaults {
    std::string wrong;              ///< what would be read wrongly, with its line; empty if nothing
    std::vector<std::string> lost;  ///< what is left out, for example "entities of type 3DSOLID (2)"
};

/// Complexity: linear.
DxfFaults find_dxf_faults(std::string_view text);

}  // namespace octopair::io
