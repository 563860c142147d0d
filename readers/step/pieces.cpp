#include "pieces.hpp"

#include <BRepBndLib.hxx>
#include <BRepBuilderAPI_Sewing.hxx>
#include <BRepLib.hxx>
#include <BRep_Builder.hxx>
#include <BRep_Tool.hxx>
#include <Bnd_Box.hxx>
#include <TopExp_Explorer.hxx>
#include <TopoDS_Iterator.hxx>
#include <TopoDS_Solid.hxx>

#include <algorithm>
#include <cmath>

namespace octopair::reader {

namespace {

/// Returns the largest gap, in mm, across which faces outside of solids are neighbours. It closes what files of IGES leave open.
double gap_for(const TopoDS_Shape& shape) { return std::min(0.01, 1e-5 * size_of(shape)); }

/// Joins faces at their common edges. Returns the connected shells, with outward normals if they are closed.
std::vector<TopoDS_Shape> sew(const std::vector<TopoDS_Shape>& faces, double gap) {
    BRepBuilderAPI_Sewing sewing(gap);
    for (const TopoDS_Shape& face : faces) sewing.Add(face);
    sewing.Perform();
    const TopoDS_Shape sewn = sewing.SewedShape();
    std::vector<TopoDS_Shape> shells;
    for (TopExp_Explorer shell(sewn, TopAbs_SHELL); shell.More(); shell.Next()) {
        if (!BRep_Tool::IsClosed(shell.Current())) {
            shells.push_back(shell.Current());
            continue;
        }
        TopoDS_Solid solid;
        BRep_Builder().MakeSolid(solid);
        BRep_Builder().Add(solid, shell.Current());
        BRepLib::OrientClosedSolid(solid);
        shells.push_back(solid);
    }
    for (TopExp_Explorer face(sewn, TopAbs_FACE, TopAbs_SHELL); face.More(); face.Next())
        shells.push_back(face.Current());
    return shells;
}

class PieceWalk {
public:
    explicit PieceWalk(const ShapeNames& names) : names_(names) {}

    /// Adds the pieces of a shape; `name`: its path.
    void add(const TopoDS_Shape& shape, const std::string& name) {
        switch (shape.ShapeType()) {
            case TopAbs_COMPOUND:
            case TopAbs_COMPSOLID: return add_group(shape, name);
            case TopAbs_SOLID: return pieces.push_back({shape, 0, name});
            case TopAbs_SHELL:
            case TopAbs_FACE: return add_faces({shape}, gap_for(shape), name);
            default: return;
        }
    }

    std::vector<Piece> pieces;

private:
    /// Faces in different groups are never joined, for two parts may have edges in common where they touch.
    void add_group(const TopoDS_Shape& group, const std::string& name) {
        std::vector<TopoDS_Shape> faces;
        for (TopoDS_Iterator inner(group); inner.More(); inner.Next()) {
            const TopAbs_ShapeEnum kind = inner.Value().ShapeType();
            if (kind == TopAbs_SHELL || kind == TopAbs_FACE) {
                faces.push_back(inner.Value());
            } else {
                add(inner.Value(), below(name, inner.Value()));
            }
        }
        if (!faces.empty()) add_faces(faces, gap_for(group), name);
    }
    void add_faces(const std::vector<TopoDS_Shape>& faces, double gap, const std::string& name) {
        for (const TopoDS_Shape& shell : sew(faces, gap)) pieces.push_back({shell, gap, name});
    }
    std::string below(const std::string& name, const TopoDS_Shape& inner) const {
        const auto known = names_.find(inner);
        if (known == names_.end()) return name;
        return name.empty() ? known->second : name + "/" + known->second;
    }

    const ShapeNames& names_;
};

}  // namespace

double size_of(const TopoDS_Shape& shape) {
    Bnd_Box box;
    BRepBndLib::Add(shape, box);
    return box.IsVoid() ? 0 : std::sqrt(box.SquareExtent());
}

std::vector<Piece> pieces_of(const TopoDS_Shape& part, const ShapeNames& names) {
    PieceWalk walk(names);
    walk.add(part, {});
    return std::move(walk.pieces);
}

}  // namespace octopair::reader
