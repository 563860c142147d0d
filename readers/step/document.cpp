#include "document.hpp"

#include <IGESCAFControl_Reader.hxx>
#include <IGESData_IGESEntity.hxx>
#include <IGESGeom_TrimmedSurface.hxx>
#include <IGESSolid_ManifoldSolid.hxx>
#include <Interface_CheckIterator.hxx>
#include <Interface_InterfaceModel.hxx>
#include <Interface_Static.hxx>
#include <STEPCAFControl_Reader.hxx>
#include <StepShape_ShellBasedSurfaceModel.hxx>
#include <StepShape_SolidModel.hxx>
#include <TransferBRep.hxx>
#include <XCAFApp_Application.hxx>
#include <XSControl_TransferReader.hxx>
#include <XSControl_WorkSession.hxx>

#include <algorithm>
#include <cstdio>
#include <stdexcept>

namespace octopair::reader {

namespace {

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

/// Returns the type that a solid or a face outside of solids has in the file; nothing for other entities.
const char* type_of(const Handle(Standard_Transient) & entity) {
    if (entity->IsKind(STANDARD_TYPE(StepShape_SolidModel))) return "solid";
    if (entity->IsKind(STANDARD_TYPE(StepShape_ShellBasedSurfaceModel))) return "surface model";
    if (entity->IsKind(STANDARD_TYPE(IGESSolid_ManifoldSolid))) return "solid";
    if (entity->IsKind(STANDARD_TYPE(IGESGeom_TrimmedSurface))) return "trimmed surface";
    return nullptr;
}

/// Notes what the file has and Open CASCADE did not make, and names that are of no part.
void look_at_entities(const XSControl_WorkSession& session, Document& document) {
    const Handle(Interface_InterfaceModel) model = session.Model();
    const Handle(Transfer_TransientProcess) made = session.TransferReader()->TransientProcess();
    for (int i = 1; i <= model->NbEntities(); ++i) {
        const Handle(Standard_Transient) entity = model->Value(i);
        const TopoDS_Shape shape = TransferBRep::ShapeResult(made, entity);
        const char* const type = type_of(entity);
        if (shape.IsNull()) {
            if (type != nullptr) document.lost.add(type, model->StringLabel(entity)->ToCString());
            continue;
        }
        const Handle(IGESData_IGESEntity) named = Handle(IGESData_IGESEntity)::DownCast(entity);
        if (named.IsNull() || !named->HasName()) continue;
        std::string name = named->NameValue()->ToCString();
        std::replace(name.begin(), name.end(), '/', '|');
        document.names.emplace(shape, name);
    }
}

/// Returns what the file lacks or has wrong.
std::string faults_of(XSControl_WorkSession& session) {
    std::string first;
    int faults = 0;
    Interface_CheckIterator checks = session.ModelCheckList();
    for (checks.Start(); checks.More(); checks.Next()) {
        if (checks.Value()->HasFailed() && faults++ == 0) first = checks.Value()->CFail(1);
    }
    if (faults == 0) return {};
    const std::string count = faults == 1 ? "1 fault" : std::to_string(faults) + " faults";
    return "Open CASCADE finds " + count + ", so parts may be missing; the first: " + first;
}

template <typename Reader>
void read(const std::string& file, Document& document) {
    Reader reader;
    reader.SetNameMode(true);
    reader.SetColorMode(false);
    reader.SetLayerMode(false);
    if (reader.ReadFile(file.c_str()) != IFSelect_RetDone) throw std::runtime_error("Open CASCADE cannot parse it");
    document.faults = faults_of(*session_of(reader));
    if (!reader.Transfer(document.content)) throw std::runtime_error("Open CASCADE finds no shapes in it");
    look_at_entities(*session_of(reader), document);
}

}  // namespace

Document read_document(const std::string& file) {
    Document document;
    XCAFApp_Application::GetApplication()->NewDocument("MDTV-XCAF", document.content);
    Interface_Static::SetCVal("xstep.cascade.unit", "MM");
    if (is_iges(file)) {
        read<IGESCAFControl_Reader>(file, document);
    } else {
        read<STEPCAFControl_Reader>(file, document);
    }
    return document;
}

}  // namespace octopair::reader
