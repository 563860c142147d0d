// Start here to add a new mesh format.
#include "io/formats/format_table.hpp"

#include <algorithm>
#include <array>

namespace octopair::io {

namespace {

constexpr FileFormat own(std::string_view name, std::string_view endings) {
    return {name, endings, FormatReader::octopair, AxisChange::none, {}};
}

constexpr FileFormat imported(std::string_view name, std::string_view endings, AxisChange axes = AxisChange::none) {
    return {name, endings, FormatReader::assimp, axes, {}};
}

constexpr FileFormat by_program(std::string_view name, std::string_view endings, std::string_view remedy) {
    return {name, endings, FormatReader::program, AxisChange::none, remedy};
}

constexpr FileFormat refused(std::string_view name, std::string_view endings, std::string_view remedy) {
    return {name, endings, FormatReader::nobody, AxisChange::none, remedy};
}

constexpr std::string_view by_step = "install octopair-step, or export it as glTF, OBJ or STL from a CAD program",
                           from_cad = "export it as glTF, OBJ or STL from a CAD program, for example FreeCAD",
                           from_its_program = "export it as glTF, OBJ or STL from the program that wrote it",
                           from_scene = "convert it to glTF, for example with Blender",
                           from_points = "octopair needs surfaces or boxes; save boxes or spheres as .npy or .csv",
                           no_model = "give octopair a model, or boxes as .npy or .csv";

// The axis changes were found with Assimp 5.2. tests/io/assimp_axes_test.cpp checks them with a block in each of these formats.
constexpr auto formats = std::to_array<FileFormat>({
    own("NumPy", ".npy"),
    own("CSV", ".csv"),
    own("JSON", ".json"),
    own("OBJ", ".obj"),
    own("STL", ".stl"),
    own("PLY", ".ply"),
    own("OFF", ".off"),
    own("glTF", ".gltf"),
    own("binary glTF", ".glb"),
    own("3MF", ".3mf"),
    own("model stream", ".opmodel"),
    {"IFC", ".ifc .ifczip", FormatReader::checked_assimp, AxisChange::turned, {}},
    imported("3D GameStudio terrain", ".hmp"),
    imported("3DS", ".3ds .prj", AxisChange::turned),
    imported("AC3D", ".ac .ac3d .acc"),
    imported("AMF", ".amf"),
    imported("ASE", ".ase .ask", AxisChange::turned),
    imported("Assimp binary", ".assbin"),
    imported("Blender", ".blend"),
    imported("Blitz3D", ".b3d", AxisChange::mirrored),
    imported("BSP", ".bsp .pk3"),
    imported("BVH", ".bvh"),
    imported("COLLADA", ".dae .zae"),
    imported("CharacterStudio motion", ".csm"),
    imported("DXF", ".dxf", AxisChange::turned),
    imported("DirectX", ".x", AxisChange::mirrored),
    imported("FBX", ".fbx"),
    imported("IQM", ".iqm", AxisChange::turned),
    imported("Irrlicht", ".irr .irrmesh"),
    imported("LightWave", ".lwo .lxo", AxisChange::mirrored),
    imported("LightWave scene", ".lws .mot", AxisChange::mirrored),
    imported("MD2", ".md2", AxisChange::turned),
    imported("MD3", ".md3", AxisChange::turned),
    imported("MD5", ".md5mesh .md5anim .md5camera", AxisChange::turned),
    imported("MDC", ".mdc", AxisChange::turned),
    imported("MDL", ".mdl", AxisChange::turned),
    imported("MilkShape", ".ms3d"),
    imported("NFF", ".nff .enff"),
    imported("Nendo", ".ndo"),
    imported("Ogre", ".mesh .mesh.xml"),
    imported("OpenGEX", ".ogex"),
    imported("PMX", ".pmx", AxisChange::mirrored),
    imported("Quick3D", ".q3o .q3s"),
    imported("Silo", ".sib"),
    imported("Terragen", ".ter"),
    imported("Unreal", ".3d .uc", AxisChange::mirrored),
    imported("Valve SMD", ".smd .vta"),
    imported("X3D", ".x3d .x3db"),
    imported("XGL", ".xgl .zgl"),
    imported("raw triangles", ".raw"),
    imported("trueSpace", ".cob .scn"),
    refused("3ds Max", ".max", from_its_program),
    refused("ACIS", ".sat .sab", from_cad),
    refused("Alembic", ".abc", from_scene),
    refused("binary DXF", "", "save it as text (ASCII DXF), or export glTF, OBJ or STL"),
    refused("CATIA", ".catpart .catproduct", from_its_program),
    refused("Cinema 4D", ".c4d", from_its_program),
    refused("DWG", ".dwg", from_its_program),
    refused("E57", ".e57", from_points),
    refused("FreeCAD", ".fcstd", from_its_program),
    refused("ifcXML", ".ifcxml", "export it as IFC2x3 in STEP form (.ifc), or as glTF or OBJ"),
    by_program("IGES", ".igs .iges", by_step),
    refused("Inventor", ".ipt .iam", from_its_program),
    refused("JPEG", ".jpg .jpeg", no_model),
    refused("JT", ".jt", from_cad),
    refused("LAS", ".las .laz", from_points),
    refused("Maya", ".ma .mb", from_its_program),
    refused("Microsoft compound document", "", from_its_program),
    refused("NPZ", ".npz", "save its array as .npy with numpy.save"),
    refused("Navisworks", ".nwd .nwc .nwf", from_its_program),
    refused("PCD", ".pcd", from_points),
    refused("PDF", ".pdf", no_model),
    refused("PNG", ".png", no_model),
    refused("Parasolid", ".x_t .x_b .xmt_txt", from_cad),
    refused("Revit", ".rvt .rfa", "export it as IFC2x3, glTF or OBJ"),
    refused("Rhino", ".3dm", from_its_program),
    by_program("STEP", ".step .stp .p21", by_step),
    refused("SketchUp", ".skp", from_its_program),
    refused("SolidWorks", ".sldprt .sldasm", from_its_program),
    refused("USD", ".usd .usda .usdc .usdz", from_scene),
    refused("VRML", ".wrl .vrml", "convert it to X3D or glTF, for example with Blender"),
    refused("VTK", ".vtk .vtp .vtu", "save it as STL, PLY or OBJ, for example with ParaView"),
});

}  // namespace

bool FileFormat::has_ending(std::string_view ending) const {
    if (ending.empty()) return false;
    for (std::string_view rest = endings; !rest.empty();) {
        const std::size_t end = std::min(rest.find(' '), rest.size());
        if (rest.substr(0, end) == ending) return true;
        rest.remove_prefix(std::min(end + 1, rest.size()));
    }
    return false;
}

std::span<const FileFormat> file_formats() { return formats; }

const FileFormat* format_with_ending(std::string_view ending) {
    const auto found = std::find_if(formats.begin(), formats.end(),
                                    [&](const FileFormat& format) { return format.has_ending(ending); });
    return found == formats.end() ? nullptr : &*found;
}

}  // namespace octopair::io
