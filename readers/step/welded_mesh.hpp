// WeldedMesh: the triangles of faces, joined where faces share an edge.
#pragma once

#include <TopoDS_Face.hxx>
#include <TopoDS_Shape.hxx>

#include <array>
#include <climits>
#include <cstddef>
#include <cstdint>
#include <map>
#include <unordered_map>
#include <vector>

#include "stream_writer.hpp"

class gp_Pnt;
class Poly_Triangulation;

namespace octopair::reader {

/// Vertices on a common edge are one, because they are numbered by the edge: their coordinates may differ by rounding. Vertices with equal
/// coordinates are one, too.
class WeldedMesh {
public:
    /// Adds the triangles of a face. Returns false if it has none. Requires: BRepMesh triangulated it together with its neighbours.
    bool add(const TopoDS_Face& face);

    StreamedShape shape;

private:
    struct Nodes;

    std::vector<std::uint32_t> numbers_of(const TopoDS_Face& face, const Nodes& nodes);
    std::uint32_t number_at(const gp_Pnt& point);
    void add_triangle(const std::array<std::uint32_t, 3>& corners);

    struct Hash {
        std::size_t operator()(const TopoDS_Shape& part) const { return std::size_t(part.HashCode(INT_MAX)); }
    };
    struct Same {
        bool operator()(const TopoDS_Shape& a, const TopoDS_Shape& b) const { return a.IsSame(b); }
    };
    std::unordered_map<TopoDS_Shape, std::vector<std::uint32_t>, Hash, Same> of_edges_;  // of the nodes of an edge, in order
    std::unordered_map<TopoDS_Shape, std::uint32_t, Hash, Same> of_ends_;                 // of the ends of edges
    std::map<std::array<double, 3>, std::uint32_t> at_points_;
};

}  // namespace octopair::reader
