// octopair-step: reads STEP (AP203, AP214, AP242) and IGES by Open CASCADE, and writes a model stream (docs/formats.md, "Model streams").
//
//     octopair-step [--chord MM] FILE
//
// Each solid of a part is a shape, and so is each connected shell outside of solids. Curved faces become triangles that are at most the
// chord error away: 0.1 mm, or 1e-4 of the size of a part that is smaller than 1 m. Instances of a part share its shapes.
#include <BRepBndLib.hxx>
#include <BRepBuilderAPI_Sewing.hxx>
#include <BRepLib.hxx>
#include <BRepMesh_IncrementalMesh.hxx>
#include <BRep_Builder.hxx>
#include <BRep_Tool.hxx>
#include <Bnd_Box.hxx>
#include <IGESCAFControl_Reader.hxx>
#include <Interface_CheckIterator.hxx>
#include <Interface_Static.hxx>
#include <Message.hxx>
#include <Message_Messenger.hxx>
#include <Poly_PolygonOnTriangulation.hxx>
#include <Poly_Triangulation.hxx>
#include <STEPCAFControl_Reader.hxx>
#include <Standard_Failure.hxx>
#include <TDF_LabelSequence.hxx>
#include <TDF_Tool.hxx>
#include <TDataStd_Name.hxx>
#include <TDocStd_Document.hxx>
#include <TopExp.hxx>
#include <TopExp_Explorer.hxx>
#include <TopLoc_Location.hxx>
#include <TopoDS.hxx>
#include <TopoDS_Edge.hxx>
#include <TopoDS_Face.hxx>
#include <TopoDS_Iterator.hxx>
#include <TopoDS_Shape.hxx>
#include <TopoDS_Solid.hxx>
#include <TopoDS_Vertex.hxx>
#include <XCAFApp_Application.hxx>
#include <XCAFDoc_DocumentTool.hxx>
#include <XCAFDoc_ShapeTool.hxx>
#include <XSControl_WorkSession.hxx>
#include <gp_Trsf.hxx>

#include <algorithm>
#include <array>
#include <climits>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <exception>
#include <map>
#include <optional>
#include <stdexcept>
#include <string>
#include <unordered_map>
#include <utility>
#include <vector>

#include "stream_writer.hpp"

namespace {

using octopair::reader::StreamedShape;
using octopair::reader::StreamWriter;
using Point = std::array<double, 3>;

struct Options {
    std::string file;
    double chord = 0;  ///< in mm; 0: the default
};

Options parse(int count, char** words) {
    Options options;
    for (int i = 1; i < count; ++i) {
        const std::string word = words[i];
        if (word == "--chord" && i + 1 < count) {
            options.chord = std::strtod(words[++i], nullptr);
            if (!(options.chord > 0) || !std::isfinite(options.chord)) throw std::runtime_error("--chord needs a length above 0");
        } else if (options.file.empty()) {
            options.file = word;
        } else {
            throw std::runtime_error("one file, not also " + word);
        }
    }
    if (options.file.empty()) throw std::runtime_error("octopair-step [--chord MM] FILE");
    return options;
}

bool is_iges(const std::string& file) {
    std::FILE* const opened = std::fopen(file.c_str(), "rb");
    if (opened == nullptr) throw std::runtime_error("cannot open " + file);
    std::string head(4096, '\0');
    head.resize(std::fread(head.data(), 1, head.size(), opened));
    std::fclose(opened);
    return head.find("ISO-10303-21") == std::string::npos;
}

Handle(XSControl_WorkSession) session_of(const STEPCAFControl_Reader& reader) { return reader.Reader().WS(); }
Handle(XSControl_WorkSession) session_of(const IGESCAFControl_Reader& reader) { return reader.WS(); }

/// Reads a file into a document. Returns what Open CASCADE finds missing or wrong in it, which it would leave out in silence; or an empty text.
template <typename Reader>
std::string transfer(Reader& reader, const std::string& file, Handle(TDocStd_Document) & document) {
    reader.SetNameMode(true);
    reader.SetColorMode(false);
    reader.SetLayerMode(false);
    if (reader.ReadFile(file.c_str()) != IFSelect_RetDone) throw std::runtime_error("Open CASCADE cannot parse it");
    std::string first;
    int faults = 0;
    Interface_CheckIterator checks = session_of(reader)->ModelCheckList();
    for (checks.Start(); checks.More(); checks.Next()) {
        if (checks.Value()->HasFailed() && faults++ == 0) first = checks.Value()->CFail(1);
    }
    if (!reader.Transfer(document)) throw std::runtime_error("Open CASCADE finds no shapes in it");
    if (faults == 0) return {};
    return "Open CASCADE finds " + std::to_string(faults) + " faults, so parts may be missing; the first: " + first;
}

std::string name_of(const TDF_Label& label) {
    Handle(TDataStd_Name) name;
    if (!label.FindAttribute(TDataStd_Name::GetID(), name)) return {};
    const TCollection_ExtendedString& text = name->Get();
    std::string utf8(std::size_t(text.LengthOfCString()) + 1, '\0');
    Standard_PCharacter end = utf8.data();
    utf8.resize(std::size_t(text.ToUTF8CString(end)));
    return utf8;
}

/// Returns whether Open CASCADE gave a label its name: an entry of the document, a number, or a kind of shape.
bool is_made_up(const std::string& name) {
    constexpr std::array<const char*, 9> kinds = {"", "COMPOUND", "COMPSOLID", "SOLID", "SHELL", "FACE", "WIRE", "EDGE", "VERTEX"};
    return name.starts_with("=>") || name.starts_with("NAUO") ||
           std::any_of(kinds.begin(), kinds.end(), [&](const char* kind) { return name == kind; });
}

/// Joins the triangles of faces. Vertices on a common edge are one, because they are numbered by the edge: their coordinates may differ by
/// rounding. Vertices with equal coordinates are one, too.
class WeldedMesh {
public:
    /// Adds the triangles of a face. Returns false if it has none.
    bool add(const TopoDS_Face& face) {
        TopLoc_Location location;
        const Handle(Poly_Triangulation) triangulation = BRep_Tool::Triangulation(face, location);
        if (triangulation.IsNull()) return false;
        const std::vector<std::uint32_t> numbers = numbers_of(face, triangulation, location);
        const bool turned = (face.Orientation() == TopAbs_REVERSED) != location.Transformation().IsNegative();
        for (int i = 1; i <= triangulation->NbTriangles(); ++i) {
            int a = 0, b = 0, c = 0;
            triangulation->Triangle(i).Get(a, b, c);
            if (turned) std::swap(b, c);
            add_triangle({numbers[std::size_t(a)], numbers[std::size_t(b)], numbers[std::size_t(c)]});
        }
        return true;
    }

    StreamedShape shape;

private:
    static constexpr std::uint32_t unknown = 0xFFFFFFFF;

    /// Returns the number of the vertex of each node. Nodes are numbered from 1.
    std::vector<std::uint32_t> numbers_of(const TopoDS_Face& face, const Handle(Poly_Triangulation) & triangulation,
                                          const TopLoc_Location& location) {
        std::vector<std::uint32_t> numbers(std::size_t(triangulation->NbNodes()) + 1, unknown);
        const auto number = [&](int node, std::uint32_t& known) {
            std::uint32_t& own = numbers[std::size_t(node)];
            if (own == unknown) own = known != unknown ? known : number_at(triangulation->Node(node).Transformed(location));
            if (known == unknown) known = own;
        };
        for (TopExp_Explorer edges(face, TopAbs_EDGE); edges.More(); edges.Next()) {
            const TopoDS_Edge& edge = TopoDS::Edge(edges.Current());
            const Handle(Poly_PolygonOnTriangulation) nodes = BRep_Tool::PolygonOnTriangulation(edge, triangulation, location);
            if (nodes.IsNull()) continue;
            std::vector<std::uint32_t>& inner = of_edges_[edge];
            inner.resize(std::size_t(nodes->NbNodes()), unknown);
            const TopoDS_Vertex first = TopExp::FirstVertex(edge), last = TopExp::LastVertex(edge);
            for (int i = 1; i <= nodes->NbNodes(); ++i) {
                const TopoDS_Vertex& end = i == 1 ? first : i == nodes->NbNodes() ? last : TopoDS_Vertex();
                number(nodes->Node(i), end.IsNull() ? inner[std::size_t(i - 1)] : of_ends_.try_emplace(end, unknown).first->second);
            }
        }
        for (int node = 1; node <= triangulation->NbNodes(); ++node) {
            std::uint32_t unshared = unknown;
            number(node, unshared);
        }
        return numbers;
    }
    std::uint32_t number_at(const gp_Pnt& point) {
        const auto [at, is_new] =
            at_points_.try_emplace({point.X() + 0.0, point.Y() + 0.0, point.Z() + 0.0}, std::uint32_t(shape.vertices.size()));
        if (is_new) shape.vertices.push_back(at->first);
        return at->second;
    }
    void add_triangle(const std::array<std::uint32_t, 3>& corners) {
        if (corners[0] != corners[1] && corners[1] != corners[2] && corners[2] != corners[0])
            shape.triangles.push_back(corners);
    }

    struct Hash {
        std::size_t operator()(const TopoDS_Shape& part) const { return std::size_t(part.HashCode(INT_MAX)); }
    };
    struct Same {
        bool operator()(const TopoDS_Shape& a, const TopoDS_Shape& b) const { return a.IsSame(b); }
    };
    std::unordered_map<TopoDS_Shape, std::vector<std::uint32_t>, Hash, Same> of_edges_;  // of the nodes of an edge, in order
    std::unordered_map<TopoDS_Shape, std::uint32_t, Hash, Same> of_ends_;                 // of the ends of edges
    std::map<Point, std::uint32_t> at_points_;
};

double size_of(const TopoDS_Shape& shape) {
    Bnd_Box box;
    BRepBndLib::Add(shape, box);
    return box.IsVoid() ? 0 : std::sqrt(box.SquareExtent());
}

double chord_for(const TopoDS_Shape& shape, const Options& options) {
    return options.chord > 0 ? options.chord : std::min(0.1, 1e-4 * size_of(shape));
}

/// Returns the largest gap, in mm, across which faces outside of solids are taken for neighbours. It closes what files of IGES leave open.
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

/// Returns the connected shells of the faces outside of solids. Faces in different groups of a file are never joined, for two parts may
/// have edges in common where they touch.
std::vector<TopoDS_Shape> shells_outside_of_solids(const TopoDS_Shape& shape) {
    std::vector<TopoDS_Shape> shells, faces;
    if (shape.ShapeType() == TopAbs_FACE) return {shape};
    if (shape.ShapeType() == TopAbs_SOLID) return {};
    for (TopoDS_Iterator part(shape); part.More(); part.Next()) {
        switch (part.Value().ShapeType()) {
            case TopAbs_COMPOUND: {
                std::vector<TopoDS_Shape> inner = shells_outside_of_solids(part.Value());
                shells.insert(shells.end(), inner.begin(), inner.end());
                break;
            }
            case TopAbs_SHELL:
            case TopAbs_FACE: faces.push_back(part.Value()); break;
            default: break;
        }
    }
    if (faces.empty()) return shells;
    std::vector<TopoDS_Shape> sewn = sew(faces, gap_for(shape));
    shells.insert(shells.end(), sewn.begin(), sewn.end());
    return shells;
}

/// Writes the occurrences of all parts.
class AssemblyWalk {
public:
    AssemblyWalk(const Handle(XCAFDoc_ShapeTool) & tool, const Options& options, StreamWriter& writer)
        : tool_(tool), options_(options), writer_(writer) {}

    void run() {
        TDF_LabelSequence roots;
        tool_->GetFreeShapes(roots);
        for (int i = 1; i <= roots.Length(); ++i) visit(roots.Value(i), {}, gp_Trsf(), "");
        writer_.end(parts_, read_, lost_);
    }

private:
    /// `above`: path of what contains the label; `place`: transform of that.
    void visit(const TDF_Label& label, const std::string& above, const gp_Trsf& place, const std::string& parent) {
        TDF_Label part = label;
        if (tool_->IsReference(label)) (void)XCAFDoc_ShapeTool::GetReferredShape(label, part);
        const gp_Trsf here = place * XCAFDoc_ShapeTool::GetLocation(label).Transformation();
        const std::string product = name_of(part);
        std::string name = is_made_up(name_of(label)) ? product : name_of(label);
        std::replace(name.begin(), name.end(), '/', '|');
        std::string path = above.empty() ? name : above + "/" + name;
        if (is_made_up(name)) {  // a solid of a product: it has the name of that
            name = parent.empty() ? "part" : parent;
            path = above.empty() ? name : above;
        }
        // Equal names below one another are numbered; those of a product and of its solids do not count as equal.
        if (const int before = occurrences_[{path, tool_->IsAssembly(part)}]++; before > 0) path += "#" + std::to_string(before + 1);
        if (tool_->IsAssembly(part)) {
            TDF_LabelSequence components;
            XCAFDoc_ShapeTool::GetComponents(part, components);
            for (int i = 1; i <= components.Length(); ++i) visit(components.Value(i), path, here, name);
            return;
        }
        add(part, {path, name, is_made_up(product) ? parent : product, parent}, here);
    }

    struct Names {
        std::string path, label, product, parent;
    };

    void add(const TDF_Label& part, const Names& names, const gp_Trsf& place) {
        // Parts of construction lines alone have no geometry that could collide.
        if (!TopExp_Explorer(XCAFDoc_ShapeTool::GetShape(part), TopAbs_FACE).More()) return;
        writer_.element("the part '" + names.path + "'");
        ++parts_;
        const std::vector<std::uint32_t>& shapes = shapes_of(part, names);
        if (shapes.empty()) return lost_.add(names.product, names.path);
        ++read_;
        std::array<double, 16> transform = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1};
        for (int row = 0; row < 3; ++row) {
            for (int column = 0; column < 4; ++column)
                transform[std::size_t(4 * row + column)] = place.Value(row + 1, column + 1);
        }
        for (std::size_t i = 0; i < shapes.size(); ++i) {
            const std::string suffix = shapes.size() == 1 ? "" : ":" + std::to_string(i + 1);
            writer_.instance({.shape = shapes[i],
                              .transform = transform,
                              .name = names.path + suffix,
                              .label = names.label + suffix,
                              .type = names.product,
                              .parent = names.parent});
        }
    }

    /// Returns the shapes of a part: its solids, and its connected shells outside of solids.
    const std::vector<std::uint32_t>& shapes_of(const TDF_Label& part, const Names& names) {
        const TopoDS_Shape shape = XCAFDoc_ShapeTool::GetShape(part);
        TCollection_AsciiString entry;
        TDF_Tool::Entry(part, entry);
        const auto [at, is_new] = written_.try_emplace(entry.ToCString());
        if (!is_new) return at->second;
        int missing = 0;
        const auto write = [&](const TopoDS_Shape& piece, double gap) {
            const double chord = chord_for(piece, options_);
            BRepMesh_IncrementalMesh(piece, chord, false, 0.3, false);
            WeldedMesh mesh;
            for (TopExp_Explorer faces(piece, TopAbs_FACE); faces.More(); faces.Next())
                missing += mesh.add(TopoDS::Face(faces.Current())) ? 0 : 1;
            if (mesh.shape.triangles.empty()) return;
            mesh.shape.error = chord + gap;
            at->second.push_back(writer_.shape(mesh.shape));
        };
        for (TopExp_Explorer solid(shape, TopAbs_SOLID); solid.More(); solid.Next()) write(solid.Current(), 0);
        for (const TopoDS_Shape& shell : shells_outside_of_solids(shape)) write(shell, gap_for(shape));
        if (missing > 0) {
            writer_.warning("'" + names.path + "' lacks " + std::to_string(missing) +
                            " faces, which Open CASCADE cannot triangulate");
        }
        return at->second;
    }

    Handle(XCAFDoc_ShapeTool) tool_;
    const Options& options_;
    StreamWriter& writer_;
    std::map<std::string, std::vector<std::uint32_t>> written_;  // by the entries of parts in the document
    std::map<std::pair<std::string, bool>, int> occurrences_;      // of paths: of assemblies, and of parts
    octopair::reader::LostCounts lost_;
    std::uint64_t parts_ = 0, read_ = 0;
};

void run(const Options& options) {
    // Open CASCADE writes messages to standard output, which is the stream.
    Message::DefaultMessenger()->ChangePrinters().Clear();
    StreamWriter writer(1);
    Handle(TDocStd_Document) document;
    XCAFApp_Application::GetApplication()->NewDocument("MDTV-XCAF", document);
    std::string faults;
    Interface_Static::SetCVal("xstep.cascade.unit", "MM");
    if (is_iges(options.file)) {
        IGESCAFControl_Reader reader;
        faults = transfer(reader, options.file, document);
    } else {
        STEPCAFControl_Reader reader;
        faults = transfer(reader, options.file, document);
    }
    writer.model("mm", "z", "");
    if (!faults.empty()) writer.warning(faults);
    AssemblyWalk(XCAFDoc_DocumentTool::ShapeTool(document->Main()), options, writer).run();
}

}  // namespace

int main(int count, char** words) {
    try {
        run(parse(count, words));
        return 0;
    } catch (const Standard_Failure& failure) {
        std::fprintf(stderr, "Open CASCADE: %s\n", failure.GetMessageString());
    } catch (const std::exception& error) {
        std::fprintf(stderr, "%s\n", error.what());
    }
    return 1;
}
