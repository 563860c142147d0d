#include "document.hpp"

#include <IGESCAFControl_Reader.hxx>
#include <IGESData_IGESEntity.hxx>
#include <IGESControl_Controller.hxx>
#include <Interface_CheckIterator.hxx>
#include <Interface_InterfaceModel.hxx>
#include <Interface_Static.hxx>
#include <STEPCAFControl_Reader.hxx>
#include <STEPControl_Controller.hxx>
#include <StepData_UndefinedEntity.hxx>
#include <StepGeom_CartesianTransformationOperator3d.hxx>
#include <StepShape_ShellBasedSurfaceModel.hxx>
#include <StepShape_SolidModel.hxx>
#include <TopExp_Explorer.hxx>
#include <TransferBRep.hxx>
#include <XCAFApp_Application.hxx>
#include <XSControl_TransferReader.hxx>
#include <XSControl_WorkSession.hxx>

#include <algorithm>
#include <cstdio>
#include <stdexcept>

#include "names.hpp"

namespace octopair::reader {

namespace {

bool is_iges(const std::string& file) {
    std::FILE* const opened = std::fopen(file.c_str(), "rb");
    if (opened == nullptr) throw std::runtime_error("cannot open " + file);
    std::string head(1 << 20, '\0');
    head.resize(std::fread(head.data(), 1, head.size(), opened));
    std::fclose(opened);
    return head.find("ISO-10303-21") == std::string::npos;
}

Handle(XSControl_WorkSession) session_of(const STEPCAFControl_Reader& reader) { return reader.Reader().WS(); }
Handle(XSControl_WorkSession) session_of(const IGESCAFControl_Reader& reader) { return reader.WS(); }

/// Returns what an entity is if it is a solid, or faces outside of solids; nothing for other entities.
const char* kind_of(const Handle(Standard_Transient) & entity) {
    if (entity->IsKind(STANDARD_TYPE(StepShape_SolidModel))) return "solid";
    if (entity->IsKind(STANDARD_TYPE(StepShape_ShellBasedSurfaceModel))) return "surface model";
    if (const auto unknown = Handle(StepData_UndefinedEntity)::DownCast(entity); !unknown.IsNull()) {
        const std::string type = unknown->StepType();
        return type == "TESSELLATED_SOLID" || type == "TESSELLATED_SHELL" ? "tessellated solid" : nullptr;
    }
    const Handle(IGESData_IGESEntity) iges = Handle(IGESData_IGESEntity)::DownCast(entity);
    if (iges.IsNull()) return nullptr;
    const int number = iges->TypeNumber();
    if ((number >= 150 && number <= 184) || number == 186) return "solid";
    return number == 143 || number == 144 ? "trimmed surface" : nullptr;
}

/// Notes what the file has and Open CASCADE did not make, and names that are of no part.
void look_at_entities(const XSControl_WorkSession& session, Document& document) {
    int operators = 0;
    const Handle(Interface_InterfaceModel) model = session.Model();
    const Handle(Transfer_TransientProcess) made = session.TransferReader()->TransientProcess();
    for (int i = 1; i <= model->NbEntities(); ++i) {
        const Handle(Standard_Transient) entity = model->Value(i);
        if (entity->IsKind(STANDARD_TYPE(StepGeom_CartesianTransformationOperator3d))) ++operators;
        const TopoDS_Shape shape = TransferBRep::ShapeResult(made, entity);
        const char* const kind = kind_of(entity);
        if (shape.IsNull() || !TopExp_Explorer(shape, TopAbs_FACE).More()) {
            if (kind != nullptr) document.lost.add(kind, model->StringLabel(entity)->ToCString());
            continue;
        }
        const Handle(IGESData_IGESEntity) named = Handle(IGESData_IGESEntity)::DownCast(entity);
        if (named.IsNull() || !named->HasName() || named->NameValue().IsNull()) continue;
        std::string name = utf8_of(named->NameValue()->ToCString());
        std::replace(name.begin(), name.end(), '/', '|');
        if (!is_made_up(name)) document.names.emplace(shape, name);
    }
    if (operators > 0) {
        document.warnings.push_back("the file scales or mirrors parts by " + std::to_string(operators) +
                                    " transformation operators, which Open CASCADE reads as motions: check these parts");
    }
}

/// Adds a warning about what the file lacks or has wrong.
void look_for_faults(XSControl_WorkSession& session, Document& document) {
    std::string first;
    int faults = 0;
    Interface_CheckIterator checks = session.ModelCheckList();
    for (checks.Start(); checks.More(); checks.Next()) {
        if (checks.Value()->HasFailed() && faults++ == 0) first = checks.Value()->CFail(1);
    }
    if (faults == 0) return;
    const std::string count = faults == 1 ? "1 fault" : std::to_string(faults) + " faults";
    document.warnings.push_back("Open CASCADE finds " + count + ", so parts may be missing; the first: " + first);
}

template <typename Reader>
void read(const std::string& file, Document& document) {
    Reader reader;
    reader.SetNameMode(true);
    reader.SetColorMode(false);
    reader.SetLayerMode(false);
    if (reader.ReadFile(file.c_str()) != IFSelect_RetDone) throw std::runtime_error("Open CASCADE cannot parse it");
    look_for_faults(*session_of(reader), document);
    if (!reader.Transfer(document.content)) throw std::runtime_error("Open CASCADE finds no shapes in it");
    look_at_entities(*session_of(reader), document);
}

}  // namespace

Document read_document(const std::string& file) {
    Document document;
    XCAFApp_Application::GetApplication()->NewDocument("MDTV-XCAF", document.content);
    // The controllers define this setting.
    STEPControl_Controller::Init();
    IGESControl_Controller::Init();
    if (!Interface_Static::SetCVal("xstep.cascade.unit", "MM")) throw std::logic_error("Open CASCADE has no unit");
    if (is_iges(file)) {
        read<IGESCAFControl_Reader>(file, document);
    } else {
        read<STEPCAFControl_Reader>(file, document);
    }
    return document;
}

}  // namespace octopair::reader
