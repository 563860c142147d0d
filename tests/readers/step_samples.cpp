// Writes sample assemblies by Open CASCADE, and what its exact geometry says about their parts.
//
//     step_samples FOLDER
//
// Each file but odd.stp has the same assembly: a frame of two plates, one turned, and other parts beside them. Standard output: one JSON object
// per part with its path, and, in mm, exact volume, area and middle. The reader has to find these again in each file.
#include <BRepAlgoAPI_Cut.hxx>
#include <BRepFilletAPI_MakeFillet.hxx>
#include <BRepGProp.hxx>
#include <BRepPrimAPI_MakeBox.hxx>
#include <BRepPrimAPI_MakeCone.hxx>
#include <BRepPrimAPI_MakeCylinder.hxx>
#include <BRepPrimAPI_MakeSphere.hxx>
#include <BRepPrimAPI_MakeTorus.hxx>
#include <GProp_GProps.hxx>
#include <IGESCAFControl_Writer.hxx>
#include <IGESControl_Controller.hxx>
#include <Interface_Static.hxx>
#include <Message.hxx>
#include <Message_Messenger.hxx>
#include <STEPCAFControl_Writer.hxx>
#include <STEPControl_Controller.hxx>
#include <TDF_LabelSequence.hxx>
#include <TDataStd_Name.hxx>
#include <TDocStd_Document.hxx>
#include <TopExp_Explorer.hxx>
#include <TopoDS.hxx>
#include <XCAFApp_Application.hxx>
#include <XCAFDoc_DocumentTool.hxx>
#include <XCAFDoc_ShapeTool.hxx>
#include <gp_Ax2.hxx>
#include <gp_Trsf.hxx>

#include <cstdio>
#include <string>

namespace {

TopoDS_Shape plate_with_holes() {
    TopoDS_Shape plate = BRepPrimAPI_MakeBox(100, 60, 10);
    for (const double x : {20., 80.}) {
        const gp_Ax2 axis(gp_Pnt(x, 30, -1), gp::DZ());
        plate = BRepAlgoAPI_Cut(plate, BRepPrimAPI_MakeCylinder(axis, 6, 12));
    }
    return plate;
}

/// A box with a cavity, in which a smaller box would be free.
TopoDS_Shape housing() {
    return BRepAlgoAPI_Cut(BRepPrimAPI_MakeBox(50, 40, 30), BRepPrimAPI_MakeBox(gp_Pnt(5, 5, 5), gp_Pnt(45, 35, 25)));
}

TopoDS_Shape rounded_block() {
    const TopoDS_Shape block = BRepPrimAPI_MakeBox(30, 20, 10);
    BRepFilletAPI_MakeFillet fillet(block);
    for (TopExp_Explorer edge(block, TopAbs_EDGE); edge.More(); edge.Next())
        fillet.Add(2, TopoDS::Edge(edge.Current()));
    return fillet.Shape();
}

gp_Trsf moved(double x, double y, double z, double turn = 0) {
    gp_Trsf place;
    if (turn != 0) place.SetRotation(gp_Ax1(gp_Pnt(0, 0, 0), gp_Dir(1, 2, 3)), turn);
    place.SetTranslationPart(gp_Vec(x, y, z));
    return place;
}

/// An assembly of parts in one document.
class Assembly {
public:
    Assembly() {
        XCAFApp_Application::GetApplication()->NewDocument("MDTV-XCAF", document_);
        shapes_ = XCAFDoc_DocumentTool::ShapeTool(document_->Main());
    }

    /// Parts that a reader finds hard: a box of half a micrometre, and names that numbering could make equal.
    void add_odd_parts() {
        const TDF_Label assembly = named(shapes_->NewShape(), "Odd");
        put(assembly, add_part("Speck", BRepPrimAPI_MakeBox(5e-4, 5e-4, 5e-4)), "Speck", moved(100, 0, 0));
        double x = 0;
        for (const char* name : {"Same", "Same", "Same#2"}) {
            put(assembly, add_part(name, BRepPrimAPI_MakeBox(1, 1, 1)), name, moved(x, 0, 0));
            x += 10;
        }
        shapes_->UpdateAssemblies();
    }

    /// Adds the sample, and prints what is known of it.
    void add_sample() {
        const TDF_Label assembly = named(shapes_->NewShape(), "Sample");
        const TDF_Label frame = named(shapes_->NewShape(), "Frame");
        const TDF_Label plate = add_part("Plate", plate_with_holes());
        put(frame, plate, "Plate", moved(0, 0, 0));
        put(frame, plate, "High", moved(0, 0, 60, 0.5));
        put(assembly, frame, "Frame", moved(1000, 0, 0, 0.25));
        put(assembly, add_part("Block", rounded_block()), "Block", moved(0, 200, 0, 1));
        put(assembly, add_part("Ball", BRepPrimAPI_MakeSphere(15)), "Ball", moved(0, 400, 0));
        put(assembly, add_part("Ring", BRepPrimAPI_MakeTorus(30, 8)), "Ring", moved(0, 600, 0, 0.7));
        put(assembly, add_part("Cone", BRepPrimAPI_MakeCone(20, 5, 40)), "Cone", moved(0, 800, 0));
        put(assembly, add_part("Pin", BRepPrimAPI_MakeCylinder(0.5, 3)), "Pin", moved(0, 900, 0));
        put(assembly, add_part("Housing", housing()), "Housing", moved(0, 1000, 0, 0.3));
        put(assembly, add_part("77001", BRepPrimAPI_MakeBox(gp_Pnt(22, 17, 12), gp_Pnt(28, 22, 18))), "77001",
            moved(0, 1000, 0, 0.3));
        shapes_->UpdateAssemblies();
        print(assembly, "Sample", gp_Trsf());
    }

    const Handle(TDocStd_Document) & document() const { return document_; }

private:
    static TDF_Label named(const TDF_Label& label, const char* name) {
        TDataStd_Name::Set(label, name);
        return label;
    }
    TDF_Label add_part(const char* name, const TopoDS_Shape& shape) {
        return named(shapes_->AddShape(shape, false), name);
    }
    void put(const TDF_Label& assembly, const TDF_Label& part, const char* name, const gp_Trsf& place) {
        named(shapes_->AddComponent(assembly, part, TopLoc_Location(place)), name);
    }
    void print(const TDF_Label& label, const std::string& path, const gp_Trsf& place) const {
        TDF_LabelSequence components;
        XCAFDoc_ShapeTool::GetComponents(label, components);
        for (int i = 1; i <= components.Length(); ++i) {
            const TDF_Label component = components.Value(i);
            TDF_Label part;
            (void)XCAFDoc_ShapeTool::GetReferredShape(component, part);
            Handle(TDataStd_Name) name;
            (void)component.FindAttribute(TDataStd_Name::GetID(), name);
            const std::string below = path + "/" + TCollection_AsciiString(name->Get()).ToCString();
            const gp_Trsf here = place * XCAFDoc_ShapeTool::GetLocation(component).Transformation();
            if (XCAFDoc_ShapeTool::IsAssembly(part)) {
                print(part, below, here);
                continue;
            }
            GProp_GProps volume, area;
            BRepGProp::VolumeProperties(XCAFDoc_ShapeTool::GetShape(part), volume);
            BRepGProp::SurfaceProperties(XCAFDoc_ShapeTool::GetShape(part), area);
            const gp_Pnt middle = volume.CentreOfMass().Transformed(here);
            std::printf("{\"name\": \"%s\", \"volume\": %.17g, \"area\": %.17g, \"middle\": [%.17g, %.17g, %.17g]}\n",
                        below.c_str(), volume.Mass(), area.Mass(), middle.X(), middle.Y(), middle.Z());
        }
    }

    Handle(TDocStd_Document) document_;
    Handle(XCAFDoc_ShapeTool) shapes_;
};

bool write_step(const Assembly& sample, const std::string& path, const char* schema, const char* unit) {
    Interface_Static::SetCVal("write.step.schema", schema);
    Interface_Static::SetCVal("write.step.unit", unit);
    STEPCAFControl_Writer writer;
    return writer.Transfer(sample.document()) && writer.Write(path.c_str()) == IFSelect_RetDone;
}

/// `solids`: 1 writes solids, 0 trimmed surfaces.
bool write_iges(const Assembly& sample, const std::string& path, int solids) {
    Interface_Static::SetIVal("write.iges.brep.mode", solids);
    IGESCAFControl_Writer writer;
    return writer.Transfer(sample.document()) && writer.Write(path.c_str());
}

}  // namespace

int main(int count, char** words) {
    if (count != 2) return 2;
    const std::string folder = words[1];
    Message::DefaultMessenger()->ChangePrinters().Clear();
    STEPControl_Controller::Init();
    IGESControl_Controller::Init();
    Assembly sample, odd;
    sample.add_sample();
    odd.add_odd_parts();
    const bool written =
        write_step(sample, folder + "/ap203.step", "AP203", "MM") &&
        write_step(sample, folder + "/ap214.stp", "AP214IS", "INCH") &&
        write_step(sample, folder + "/ap242.stp", "AP242DIS", "M") && write_iges(sample, folder + "/solids.igs", 1) &&
        write_iges(sample, folder + "/surfaces.iges", 0) && write_step(odd, folder + "/odd.stp", "AP214IS", "MM");
    return written ? 0 : 1;
}
