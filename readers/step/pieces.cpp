#include "pieces.hpp"

#include <BRepBndLib.hxx>
#include <BRepBuilderAPI_Sewing.hxx>
#include <BRepClass3d_SolidClassifier.hxx>
#include <BRepGProp.hxx>
#include <BRep_Builder.hxx>
#include <BRep_Tool.hxx>
#include <Bnd_Box.hxx>
#include <GProp_GProps.hxx>
#include <TopExp_Explorer.hxx>
#include <TopoDS.hxx>
#include <TopoDS_Compound.hxx>
#include <TopoDS_Iterator.hxx>
#include <TopoDS_Shell.hxx>
#include <TopoDS_Solid.hxx>
#include <TopoDS_Vertex.hxx>
#include <gp_Pnt.hxx>

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

namespace octopair::reader {

namespace {

/// Returns the largest gap, in mm, across which faces outside of solids are neighbours. It closes what files of IGES leave open.
double gap_for(const TopoDS_Shape& shape) { return std::min(0.01, 1e-4 * size_of(shape)); }

/// A shell of joined faces.
struct SewnShell {
    TopoDS_Shape shape;
    std::string name;
    Bnd_Box box = {};
    double volume = 0;  ///< of a closed shell: below 0 if its normals point inward; 0: open
};

/// Joins faces at their common edges, and appends the connected shells.
void sew(const std::vector<TopoDS_Shape>& faces, double gap, const std::string& name, std::vector<SewnShell>& shells) {
    BRepBuilderAPI_Sewing sewing(gap);
    for (const TopoDS_Shape& face : faces) sewing.Add(face);
    sewing.Perform();
    const TopoDS_Shape sewn = sewing.SewedShape();
    const auto add = [&](const TopoDS_Shape& shell) {
        SewnShell& added = shells.emplace_back(SewnShell{.shape = shell, .name = name});
        if (!BRep_Tool::IsClosed(shell)) return;
        BRepBndLib::Add(shell, added.box);
        GProp_GProps properties;
        BRepGProp::VolumeProperties(shell, properties);
        added.volume = properties.Mass();
    };
    for (TopExp_Explorer shell(sewn, TopAbs_SHELL); shell.More(); shell.Next()) add(shell.Current());
    // A face can be closed alone, as a sphere is.
    for (TopExp_Explorer face(sewn, TopAbs_FACE, TopAbs_SHELL); face.More(); face.Next()) {
        TopoDS_Shell shell;
        BRep_Builder().MakeShell(shell);
        BRep_Builder().Add(shell, face.Current());
        add(shell);
    }
}

/// Returns whether a closed shell lies inside of another one, if they do not cross: whether one of its vertices does.
bool lies_inside(const SewnShell& inner, const SewnShell& outer) {
    if (outer.box.IsOut(inner.box.CornerMin()) || outer.box.IsOut(inner.box.CornerMax())) return false;
    const TopExp_Explorer vertex(inner.shape, TopAbs_VERTEX);
    if (!vertex.More()) return false;
    TopoDS_Solid solid;
    BRep_Builder().MakeSolid(solid);
    BRep_Builder().Add(solid, outer.shape);
    const gp_Pnt point = BRep_Tool::Pnt(TopoDS::Vertex(vertex.Current()));
    return BRepClass3d_SolidClassifier(solid, point, 1e-7).State() == TopAbs_IN;
}

/// Makes pieces of shells. A closed shell whose normals point inward is a cavity of the smallest shell around it.
std::vector<Piece> pieces_of_shells(const std::vector<SewnShell>& shells) {
    std::vector<TopoDS_Shape> hollow(shells.size());  // a shell with its cavities; null without cavities
    std::vector<int> cavities(shells.size(), 0);
    std::vector<bool> is_cavity(shells.size(), false);
    for (std::size_t inner = 0; inner < shells.size(); ++inner) {
        if (shells[inner].volume >= 0) continue;
        std::optional<std::size_t> around;
        for (std::size_t outer = 0; outer < shells.size(); ++outer) {
            if (shells[outer].volume <= -shells[inner].volume || (around && shells[outer].volume >= shells[*around].volume)) continue;
            if (lies_inside(shells[inner], shells[outer])) around = outer;
        }
        if (!around) continue;
        is_cavity[inner] = true;
        ++cavities[*around];
        if (hollow[*around].IsNull()) {
            TopoDS_Compound all;
            BRep_Builder().MakeCompound(all);
            BRep_Builder().Add(all, shells[*around].shape);
            hollow[*around] = all;
        }
        BRep_Builder().Add(hollow[*around], shells[inner].shape);
    }
    std::vector<Piece> pieces;
    for (std::size_t i = 0; i < shells.size(); ++i) {
        if (is_cavity[i]) continue;
        const TopoDS_Shape& shell = shells[i].shape;
        const TopoDS_Shape& whole = !hollow[i].IsNull() ? hollow[i] : shell;
        pieces.push_back({shells[i].volume < 0 ? shell.Reversed() : whole, shells[i].name, cavities[i]});
    }
    return pieces;
}

class PieceWalk {
public:
    explicit PieceWalk(const ShapeNames& names) : names_(names) {}

    /// Adds the solids and shells of a shape; `name`: its path.
    void add(const TopoDS_Shape& shape, const std::string& name) {
        switch (shape.ShapeType()) {
            case TopAbs_COMPOUND:
            case TopAbs_COMPSOLID: return add_group(shape, name);
            case TopAbs_SOLID: return solids.push_back({shape, name, 0});
            case TopAbs_SHELL:
            case TopAbs_FACE: return sew({shape}, gap_for(shape), name, shells);
            default: return;
        }
    }

    std::vector<Piece> solids;
    std::vector<SewnShell> shells;  // outside of solids

private:
    /// Joins the faces of a compound, but not those of its inner compounds: there, two parts may have edges in common where they touch.
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
        if (!faces.empty()) sew(faces, gap_for(group), name, shells);
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
    std::vector<Piece> pieces = std::move(walk.solids);
    for (Piece& piece : pieces_of_shells(walk.shells)) pieces.push_back(std::move(piece));
    return pieces;
}

}  // namespace octopair::reader
