#include "welded_mesh.hpp"

#include <BRep_Tool.hxx>
#include <Poly_PolygonOnTriangulation.hxx>
#include <Poly_Triangulation.hxx>
#include <TopExp.hxx>
#include <TopExp_Explorer.hxx>
#include <TopLoc_Location.hxx>
#include <TopoDS.hxx>
#include <TopoDS_Edge.hxx>
#include <TopoDS_Vertex.hxx>
#include <gp_Pnt.hxx>
#include <gp_Trsf.hxx>

#include <utility>

namespace octopair::reader {

namespace {

constexpr std::uint32_t unknown = 0xFFFFFFFF;

}  // namespace

/// The nodes of a face, which are numbered from 1.
struct WeldedMesh::Nodes {
    Handle(Poly_Triangulation) all;
    TopLoc_Location location;

    gp_Pnt point(int node) const { return all->Node(node).Transformed(location); }
};

bool WeldedMesh::add(const TopoDS_Face& face) {
    Nodes nodes;
    nodes.all = BRep_Tool::Triangulation(face, nodes.location);
    if (nodes.all.IsNull()) return false;
    const std::vector<std::uint32_t> numbers = numbers_of(face, nodes);
    const bool turned = (face.Orientation() == TopAbs_REVERSED) != nodes.location.Transformation().IsNegative();
    for (int i = 1; i <= nodes.all->NbTriangles(); ++i) {
        int a = 0, b = 0, c = 0;
        nodes.all->Triangle(i).Get(a, b, c);
        if (turned) std::swap(b, c);
        add_triangle({numbers[std::size_t(a)], numbers[std::size_t(b)], numbers[std::size_t(c)]});
    }
    return true;
}

/// Returns the number of the vertex at each node.
std::vector<std::uint32_t> WeldedMesh::numbers_of(const TopoDS_Face& face, const Nodes& nodes) {
    std::vector<std::uint32_t> numbers(std::size_t(nodes.all->NbNodes()) + 1, unknown);
    // `shared`: number of the vertex of the edge, which other faces may know.
    const auto number = [&](int node, std::uint32_t& shared) {
        std::uint32_t& own = numbers[std::size_t(node)];
        if (own == unknown) own = shared != unknown ? shared : number_at(nodes.point(node));
        if (shared == unknown) shared = own;
    };
    for (TopExp_Explorer edges(face, TopAbs_EDGE); edges.More(); edges.Next()) {
        const TopoDS_Edge& edge = TopoDS::Edge(edges.Current());
        const Handle(Poly_PolygonOnTriangulation) along = BRep_Tool::PolygonOnTriangulation(edge, nodes.all, nodes.location);
        if (along.IsNull()) continue;
        const int last = along->NbNodes();
        std::vector<std::uint32_t>& inner = of_edges_[edge];
        inner.resize(std::size_t(last), unknown);
        for (int i = 2; i < last; ++i) number(along->Node(i), inner[std::size_t(i - 1)]);
        number(along->Node(1), of_ends_.try_emplace(TopExp::FirstVertex(edge), unknown).first->second);
        number(along->Node(last), of_ends_.try_emplace(TopExp::LastVertex(edge), unknown).first->second);
    }
    for (int node = 1; node <= nodes.all->NbNodes(); ++node) {
        std::uint32_t unshared = unknown;
        number(node, unshared);
    }
    return numbers;
}

std::uint32_t WeldedMesh::number_at(const gp_Pnt& point) {
    // + 0.0: -0 and 0 are one coordinate.
    const auto [at, is_new] =
        at_points_.try_emplace({point.X() + 0.0, point.Y() + 0.0, point.Z() + 0.0}, std::uint32_t(shape.vertices.size()));
    if (is_new) shape.vertices.push_back(at->first);
    return at->second;
}

void WeldedMesh::add_triangle(const std::array<std::uint32_t, 3>& corners) {
    if (corners[0] != corners[1] && corners[1] != corners[2] && corners[2] != corners[0])
        shape.triangles.push_back(corners);
}

}  // namespace octopair::reader
