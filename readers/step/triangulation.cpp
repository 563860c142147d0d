#include "triangulation.hpp"

#include <BRepAdaptor_Surface.hxx>
#include <BRepMesh_IncrementalMesh.hxx>
#include <BRep_Tool.hxx>
#include <Poly_Triangulation.hxx>
#include <Precision.hxx>
#include <TopExp_Explorer.hxx>
#include <TopLoc_Location.hxx>
#include <TopoDS.hxx>
#include <TopoDS_Face.hxx>
#include <gp_Pnt.hxx>
#include <gp_Pnt2d.hxx>
#include <gp_Vec.hxx>

#include <algorithm>
#include <array>
#include <cmath>

namespace octopair::reader {

namespace {

/// Returns the greatest distance of sampled points of a face's surface from the plane of their triangle.
double distance_of(const TopoDS_Face& face) {
    TopLoc_Location location;
    const Handle(Poly_Triangulation) triangles = BRep_Tool::Triangulation(face, location);
    if (triangles.IsNull() || !triangles->HasUVNodes()) return 0;
    const BRepAdaptor_Surface surface(face, false);
    if (surface.GetType() == GeomAbs_Plane) return 0;
    double farthest = 0;
    for (int i = 1; i <= triangles->NbTriangles(); ++i) {
        std::array<int, 3> nodes{};
        triangles->Triangle(i).Get(nodes[0], nodes[1], nodes[2]);
        std::array<gp_Pnt, 3> corners;
        std::array<gp_XY, 3> places;
        for (std::size_t k = 0; k < 3; ++k) {
            corners[k] = triangles->Node(nodes[k]).Transformed(location);
            places[k] = triangles->UVNode(nodes[k]).XY();
        }
        const gp_Vec normal = gp_Vec(corners[0], corners[1]).Crossed(gp_Vec(corners[0], corners[2]));
        if (!(normal.Magnitude() > 0)) continue;
        const std::array<gp_XY, 4> samples = {(places[0] + places[1] + places[2]) / 3, (places[0] + places[1]) / 2,
                                              (places[1] + places[2]) / 2, (places[2] + places[0]) / 2};
        for (const gp_XY& sample : samples) {
            const gp_Vec away(corners[0], surface.Value(sample.X(), sample.Y()));
            farthest = std::max(farthest, std::abs(away.Dot(normal)) / normal.Magnitude());
        }
    }
    return farthest;
}

double distance_of_all(const TopoDS_Shape& shape) {
    double farthest = 0;
    for (TopExp_Explorer face(shape, TopAbs_FACE); face.More(); face.Next())
        farthest = std::max(farthest, distance_of(TopoDS::Face(face.Current())));
    return farthest;
}

}  // namespace

double triangulate(const TopoDS_Shape& shape, double chord) {
    const double least = 1.01 * Precision::Confusion();  // Open CASCADE refuses less
    const double aim = std::max(chord, least);
    BRepMesh_IncrementalMesh(shape, aim, false, 0.3, false);
    const double loose = std::max(BRep_Tool::MaxTolerance(shape, TopAbs_EDGE), BRep_Tool::MaxTolerance(shape, TopAbs_VERTEX));
    return std::max(aim, distance_of_all(shape)) + (loose > 10 * Precision::Confusion() ? loose : 0);
}

}  // namespace octopair::reader
