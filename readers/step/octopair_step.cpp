// octopair-step: reads STEP (AP203, AP214, AP242) and IGES by Open CASCADE, and writes a model stream (docs/formats.md, "Model streams").
//
//     octopair-step [--chord MM] FILE
//
// Each solid of a part is an object, and so is each connected shell outside of solids. Curved faces become triangles that are about the chord
// error away: 0.1 mm, or 1e-4 of the size of a solid that is smaller than 1 m. Instances of a part share its shapes.
//
// document        what Open CASCADE reads, and what it loses
// names           names of parts
// pieces          the solids and shells of a part
// triangulation   triangles of their faces, and how far these are from the surface
// welded_mesh     the triangles of a piece
#include <Message.hxx>
#include <Message_Messenger.hxx>
#include <Standard_Failure.hxx>
#include <TDF_LabelSequence.hxx>
#include <TDF_Tool.hxx>
#include <TopExp_Explorer.hxx>
#include <TopoDS.hxx>
#include <XCAFDoc_DocumentTool.hxx>
#include <XCAFDoc_ShapeTool.hxx>
#include <gp_Trsf.hxx>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <map>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "document.hpp"
#include "names.hpp"
#include "pieces.hpp"
#include "stream_writer.hpp"
#include "triangulation.hpp"
#include "welded_mesh.hpp"

namespace octopair::reader {
namespace {

struct Options {
    std::string file;
    double chord = 0;  ///< in mm; 0: the default
};

Options parse(int count, char** words) {
    Options options;
    for (int i = 1; i < count; ++i) {
        const std::string word = words[i];
        if (word == "--chord" && i + 1 < count) {
            char* end = nullptr;
            options.chord = std::strtod(words[++i], &end);
            if (*end != '\0' || !(options.chord > 0) || !std::isfinite(options.chord)) throw std::runtime_error("--chord needs a length above 0");
        } else if (options.file.empty()) {
            options.file = word;
        } else {
            throw std::runtime_error("one file, not also " + word);
        }
    }
    if (options.file.empty()) throw std::runtime_error("octopair-step [--chord MM] FILE");
    return options;
}

/// Writes the occurrences of all parts.
class AssemblyWalk {
public:
    AssemblyWalk(const Document& document, const Options& options, StreamWriter& writer)
        : tool_(XCAFDoc_DocumentTool::ShapeTool(document.content->Main())),
          names_(document.names),
          options_(options),
          writer_(writer),
          lost_(document.lost) {
        for (const LostCounts::Count& lost : lost_.counts) parts_ += lost.count;
    }

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
        std::string name = name_of(label);
        if (is_made_up(name) || (is_number(name) && !is_made_up(product))) name = product;
        std::replace(name.begin(), name.end(), '/', '|');
        std::string path = above.empty() ? name : above + "/" + name;
        if (is_made_up(name)) {  // a solid of a product: it has the name of that
            name = parent.empty() ? "part" : parent;
            path = above.empty() ? name : above;
        }
        path = unused(path, tool_->IsAssembly(part));
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
        const std::vector<WrittenPiece>& pieces = pieces_of_part(part, names);
        if (pieces.empty()) return lost_.add(names.product.empty() ? "part" : names.product, names.path);
        ++read_;
        StreamedInstance instance = {.shape = 0, .transform = rows_of(place), .name = {}, .type = names.product, .parent = names.parent};
        for (std::size_t i = 0; i < pieces.size(); ++i) {
            const std::string& name = pieces[i].name;
            const std::string number = pieces.size() > 1 ? ":" + std::to_string(i + 1) : "";
            instance.shape = pieces[i].shape;
            instance.name = names.path;
            instance.label = names.label + number;
            if (!name.empty()) {
                instance.name = unused(names.path + "/" + name, false);
                instance.label = name.substr(name.rfind('/') + 1);
            } else if (pieces.size() > 1) {
                instance.name = unused(names.path + number, false);
            }
            writer_.instance(instance);
        }
    }

    /// Returns the row-major matrix of a transform.
    static std::array<double, 16> rows_of(const gp_Trsf& place) {
        std::array<double, 16> rows = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1};
        for (int row = 0; row < 3; ++row) {
            for (int column = 0; column < 4; ++column) rows[std::size_t(4 * row + column)] = place.Value(row + 1, column + 1);
        }
        return rows;
    }

    struct WrittenPiece {
        std::uint32_t shape;  // its number in the stream
        std::string name;     // as in Piece
    };

    /// Returns the pieces of a part, which are written once.
    const std::vector<WrittenPiece>& pieces_of_part(const TDF_Label& part, const Names& names) {
        TCollection_AsciiString entry;
        TDF_Tool::Entry(part, entry);
        const auto [at, is_new] = written_.try_emplace(entry.ToCString());
        if (!is_new) return at->second;
        int missing = 0, cavities = 0;
        for (const Piece& piece : pieces_of(XCAFDoc_ShapeTool::GetShape(part), names_)) {
            const double chord = options_.chord > 0 ? options_.chord : std::min(0.1, 1e-4 * size_of(piece.shape));
            cavities += piece.cavities;
            WeldedMesh mesh;
            mesh.shape.error = triangulate(piece.shape, chord);
            for (TopExp_Explorer faces(piece.shape, TopAbs_FACE); faces.More(); faces.Next())
                missing += mesh.add(TopoDS::Face(faces.Current())) ? 0 : 1;
            if (mesh.shape.triangles.empty()) continue;
            at->second.push_back({writer_.shape(mesh.shape), piece.name});
        }
        if (missing > 0) {
            writer_.warning("'" + names.path + "' lacks faces, because Open CASCADE cannot triangulate them: " + std::to_string(missing));
        }
        if (cavities > 0) {
            writer_.warning("'" + names.path +
                            "': shells inside of others, whose normals point inward, are read as cavities, not as objects: " +
                            std::to_string(cavities));
        }
        return at->second;
    }

    /// Returns a path that no other assembly, or no other part, has: with "#2", "#3" and so on after the first. A product with one solid has
    /// the path of this solid.
    std::string unused(const std::string& path, bool is_assembly) {
        int& count = occurrences_[{path, is_assembly}];
        if (count++ == 0) return path;
        for (;; ++count) {
            const std::string numbered = path + "#" + std::to_string(count);
            if (occurrences_.try_emplace({numbered, is_assembly}, 1).second) return numbered;
        }
    }

    const Handle(XCAFDoc_ShapeTool) tool_;
    const ShapeNames& names_;
    const Options& options_;
    StreamWriter& writer_;
    std::map<std::string, std::vector<WrittenPiece>> written_;  // by the entries of parts in the document
    std::map<std::pair<std::string, bool>, int> occurrences_;      // of paths: of assemblies, and of parts
    LostCounts lost_;
    std::uint64_t parts_ = 0, read_ = 0;
};

void run(const Options& options) {
    // Open CASCADE writes messages to standard output, which is the stream.
    Message::DefaultMessenger()->ChangePrinters().Clear();
    StreamWriter writer(1);
    const Document document = read_document(options.file);
    writer.model("mm", "z", "");
    for (const std::string& warning : document.warnings) writer.warning(warning);
    AssemblyWalk(document, options, writer).run();
}

}  // namespace
}  // namespace octopair::reader

int main(int count, char** words) {
    try {
        octopair::reader::run(octopair::reader::parse(count, words));
        return 0;
    } catch (const Standard_Failure& failure) {
        std::fprintf(stderr, "Open CASCADE: %s\n", failure.GetMessageString());
    } catch (const std::exception& error) {
        std::fprintf(stderr, "%s\n", error.what());
    }
    return 1;
}
