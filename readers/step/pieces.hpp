// Pieces of a part: each becomes a shape of the stream.
#pragma once

#include <TopoDS_Shape.hxx>

#include <cstddef>
#include <functional>
#include <string>
#include <unordered_map>
#include <vector>

namespace octopair::reader {

struct SamePart {
    bool operator()(const TopoDS_Shape& a, const TopoDS_Shape& b) const { return a.IsPartner(b); }
};
struct PartHash {
    std::size_t operator()(const TopoDS_Shape& shape) const { return std::hash<const void*>()(shape.TShape().get()); }
};
/// Names of shapes inside of parts, wherever they are placed.
using ShapeNames = std::unordered_map<TopoDS_Shape, std::string, PartHash, SamePart>;

struct Piece {
    TopoDS_Shape shape;
    std::string name;  ///< path of the names inside of the part; empty: none
    int cavities = 0;  ///< shells that were taken for cavities, because their normals point inward
};

/// Returns the length of the diagonal of the bounding box, in mm.
double size_of(const TopoDS_Shape& shape);

/// Returns the solids of a part, and the connected shells of its faces outside of solids. Closed shells have outward normals, and cavities.
std::vector<Piece> pieces_of(const TopoDS_Shape& part, const ShapeNames& names);

}  // namespace octopair::reader
