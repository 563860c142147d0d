// octopair-step: reads STEP (AP203, AP214, AP242) and IGES by Open CASCADE, and writes a model stream (docs/formats.md, "Model streams").
//
//     octopair-step [--chord MM] FILE
//
// Each solid of a part is a shape, and so are all its faces outside of solids together. Its curved faces become triangles that are at most the chord error away:
// 0.1 mm, or 1e-4 of the size of a part that is smaller than 1 m. Instances of a part share its shape.
#include <BRepBndLib.hxx>
#include <BRepMesh_IncrementalMesh.hxx>
#include <BRep_Tool.hxx>
#include <Bnd_Box.hxx>
#include <IGESCAFControl_Reader.hxx>
#include <Interface_CheckIterator.hxx>
#include <Interface_Static.hxx>
#include <Message.hxx>
#include <Message_Messenger.hxx>
#include <Poly_Triangulation.hxx>
#include <STEPCAFControl_Reader.hxx>
#include <Standard_Failure.hxx>
#include <TDF_LabelSequence.hxx>
#include <TDF_Tool.hxx>
#include <TDataStd_Name.hxx>
#include <TDocStd_Document.hxx>
#include <TopExp_Explorer.hxx>
#include <TopLoc_Location.hxx>
#include <TopoDS.hxx>
#include <TopoDS_Face.hxx>
#include <XCAFApp_Application.hxx>
#include <XCAFDoc_DocumentTool.hxx>
#include <XCAFDoc_ShapeTool.hxx>
#include <XSControl_WorkSession.hxx>
#include <gp_Trsf.hxx>

#include <algorithm>
#include <array>
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

/// Joins vertices with equal coordinates.
class WeldedMesh {
public:
    std::uint32_t number_of(const Point& point) {
        const auto [at, is_new] = numbers_.try_emplace(point, std::uint32_t(shape.vertices.size()));
        if (is_new) shape.vertices.push_back(point);
        return at->second;
    }
    void add(const std::array<std::uint32_t, 3>& corners) {
        if (corners[0] != corners[1] && corners[1] != corners[2] && corners[2] != corners[0])
            shape.triangles.push_back(corners);
    }

    StreamedShape shape;

private:
    std::map<Point, std::uint32_t> numbers_;
};

/// Adds the triangles of a face. Returns false if it has none.
bool add_face(const TopoDS_Face& face, WeldedMesh& mesh) {
    TopLoc_Location location;
    const Handle(Poly_Triangulation) triangulation = BRep_Tool::Triangulation(face, location);
    if (triangulation.IsNull()) return false;
    const gp_Trsf& place = location.Transformation();
    std::vector<std::uint32_t> numbers;
    for (int i = 1; i <= triangulation->NbNodes(); ++i) {
        const gp_Pnt node = triangulation->Node(i).Transformed(place);
        numbers.push_back(mesh.number_of({node.X() + 0.0, node.Y() + 0.0, node.Z() + 0.0}));
    }
    const bool turned = (face.Orientation() == TopAbs_REVERSED) != place.IsNegative();
    for (int i = 1; i <= triangulation->NbTriangles(); ++i) {
        int a = 0, b = 0, c = 0;
        triangulation->Triangle(i).Get(a, b, c);
        if (turned) std::swap(b, c);
        mesh.add({numbers[std::size_t(a - 1)], numbers[std::size_t(b - 1)], numbers[std::size_t(c - 1)]});
    }
    return true;
}

double chord_for(const TopoDS_Shape& shape, const Options& options) {
    if (options.chord > 0) return options.chord;
    Bnd_Box box;
    BRepBndLib::Add(shape, box);
    if (box.IsVoid()) return 0.1;
    return std::min(0.1, 1e-4 * std::sqrt(box.SquareExtent()));
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

    /// Returns the shapes of a part: its solids, and its shells and faces outside of solids as one.
    const std::vector<std::uint32_t>& shapes_of(const TDF_Label& part, const Names& names) {
        const TopoDS_Shape shape = XCAFDoc_ShapeTool::GetShape(part);
        TCollection_AsciiString entry;
        TDF_Tool::Entry(part, entry);
        const auto [at, is_new] = written_.try_emplace(entry.ToCString());
        if (!is_new) return at->second;
        const double chord = chord_for(shape, options_);
        BRepMesh_IncrementalMesh(shape, chord, false, 0.3, false);
        int missing = 0;
        const auto write = [&](TopExp_Explorer faces) {
            WeldedMesh mesh;
            for (; faces.More(); faces.Next()) missing += add_face(TopoDS::Face(faces.Current()), mesh) ? 0 : 1;
            if (mesh.shape.triangles.empty()) return;
            mesh.shape.error = chord;
            at->second.push_back(writer_.shape(mesh.shape));
        };
        for (TopExp_Explorer solid(shape, TopAbs_SOLID); solid.More(); solid.Next())
            write(TopExp_Explorer(solid.Current(), TopAbs_FACE));
        if (at->second.empty())
            writer_.warning("'" + names.path + "' has no solid: all its faces are one object");
        write(TopExp_Explorer(shape, TopAbs_FACE, TopAbs_SOLID));
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
