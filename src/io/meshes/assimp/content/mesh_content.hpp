// MeshContent: the result of a check of a mesh file's text, before Assimp reads the file. Declares the checks, one for each format.
// Start here to change what is done about faults of Assimp.
//
// A check finds content that Assimp 5.2 reads wrongly. Then it writes the content in a form that Assimp reads rightly, refuses the file,
// or counts what is left out. The list at each check below names the faults of Assimp that the check finds or corrects.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "io/formats/format_choice.hpp"

namespace octopair::io {

struct MeshContent {
    /// Text that Assimp reads in place of the file. Nothing: Assimp reads the file itself.
    std::optional<std::string> text;
    /// Ending of the format of `text`; empty: the ending of the file.
    std::string ending;
    /// Content that Assimp leaves out, for example "entities of type 3DSOLID (2)".
    std::vector<std::string> left_out;
    /// Unit of length that the file states, empty for one that octopair does not know; nothing: the unit is that of the format.
    std::optional<std::string> unit = {};
};

/// Counts the parts of a file that are left out, by their kind.
class LeftOut {
public:
    void add(const std::string& what, std::size_t count = 1) { counts_[what] += count; }
    /// Returns for example "nodes of type LOD (2)", in alphabetical order.
    std::vector<std::string> list() const;

private:
    std::map<std::string, std::size_t> counts_;
};

/// Checks the content of a file that Assimp is going to read.
/// Throws: Error{bad_input} with the line if Assimp would read the file wrongly; Error{io_failed}.
MeshContent check_mesh_content(const std::string& path, const KnownFormat& known);

// Each check gets the content of a file. `path` is for messages. Throws: as check_mesh_content().

/// Finds in an AC3D file what Assimp 5.2 reads wrongly, and moves lines to their places.
/// Assimp makes these errors with the file:
/// - A corner beyond the vertices becomes the first vertex. A surface with a material beyond the list is lost.
/// - A line of data that begins with a keyword is read as the model.
/// - The place of an object with surfaces does not move the object's children and lines. A rotation (rot) also turns the place.
MeshContent correct_ac3d(const std::string& path, std::string_view bytes);

/// Writes an AMF file in a form that Assimp 5.2 reads rightly.
/// Assimp makes these errors with the original:
/// - Only the first volume of an object is read, and the last mesh.
/// - It drops the part of a number behind a decimal comma. A vertex without coordinates is left out, so that all indices after it are wrong.
/// - Objects without an id, or with one id, replace each other.
/// - The angles of an instance are taken for a translation.
///
/// So all volumes of an object are written as one, in the vertices of one mesh. Colours, textures and materials are not written.
MeshContent correct_amf(const std::string& path, std::string_view bytes);

/// Writes a COLLADA file in a form that Assimp 5.2 reads rightly.
/// Assimp makes these errors with the original:
/// - <skew> is ignored. The axis of <rotate> must have the length 1, and the up of <lookat> must be perpendicular.
/// - A comma in an index is an endless loop. Negative indices are read as 0.
/// - A fan of triangles becomes one polygon. A primitive without a count is empty. A strip with fewer than three corners crashes Assimp.
/// - If an accessor does not name its values X, Y and Z, all three coordinates of a position are the first value.
/// - <extra> in a primitive is refused. Texts end at the first comment.
/// - Instances of nodes and geometries that are in other files, or missing, or within a node of a library, are lost.
/// - If two instances of a geometry share some materials, triangles of the second instance get vertices of other triangles.
/// - White space around the name of the up axis makes y the up axis.
///
/// So nodes replace their instances, transforms are written as numbers that Assimp understands, and meshes have only positions.
MeshContent correct_collada(const std::string& path, std::string_view bytes);

/// Finds in a DirectX file (.x) what Assimp 5.2 reads wrongly, and corrects it where the meaning is certain.
/// Assimp makes these errors with the file:
/// - A corner beyond the vertices is left out of its face. Faces with a material beyond the list are lost.
/// - The object after a reference in braces is lost.
/// - A comma between whole numbers of a matrix is a decimal point.
/// - Meshes outside all frames get the place of the only frame, and replace the meshes of this frame.
/// - An unnamed frame with a mesh is joined to its parent, and the frames in it are lost.
///
/// Binary and compressed files are not checked.
MeshContent correct_directx(const std::string& path, std::string_view bytes);

/// Writes a DXF file as faces and lines, which Assimp 5.2 reads rightly.
/// Assimp makes these errors with the original:
/// - A block is inserted without its rotation, rows, columns and direction of extrusion, and its position is scaled. Blocks in blocks are lost.
/// - Entities after a text that begins with a brace, and after a POLYLINE without a VERTEX, are lost.
/// - A corner of a polyface mesh is lost if the edge after it is invisible. Meshes of M x N points are lines. Every second edge of a line is lost.
/// - Entities of the paper (layouts) are read as the model.
///
/// So blocks are replaced by their entities, polylines by faces or lines, and all other entities are left out. An object is a layer.
MeshContent correct_dxf(const std::string& path, std::string_view bytes);

/// Finds in an OpenGEX file what Assimp 5.2 reads wrongly or leaves out.
/// Assimp makes these errors with the file:
/// - Structures Node and BoneNode are left out, with all that is in them.
/// - Translation, Rotation and Scale are ignored. If a node has several transforms, only the last transform counts.
/// - If a mesh has several index arrays, only the last array counts. Each face has its first three corners only.
/// - Hexadecimal indices are 0. Corners beyond the vertices are read from other memory.
MeshContent check_opengex(const std::string& path, std::string_view bytes);

/// Writes an X3D file in a form that Assimp 5.2 reads rightly.
/// Assimp makes these errors with the original:
/// - After an empty group, and after a group with USE, nodes are placed in the wrong group or lost.
/// - A comma between numbers ends the number before it, and the number after it is lost.
/// - The axis of a rotation must have the length 1.
/// - A Cone is upside down. A Cylinder has 30 sides, so it is too narrow along z. Quads, TriangleStripSet and some groups are unknown.
/// - Metadata counts as a child of a Switch.
/// - An Extrusion along a straight spine ignores its direction. Its orientations turn around the axes of the world.
/// - Indices beyond the points, and grids with too few heights, are read from other memory.
///
/// So each use of a node (USE) becomes a copy of this node, spaces separate numbers, and only groups and geometry are written.
MeshContent correct_x3d(const std::string& path, std::string_view bytes);

/// Writes an XGL file in a form that Assimp 5.2 reads rightly.
/// Assimp makes these errors with the original:
/// - It ignores all transforms, and all references to objects.
/// - It reads the comma after a whole number as a decimal point.
///
/// So the text that is returned repeats the meshes for each object, with the vertices moved to their places. It has no colours and normals,
/// which octopair does not use.
MeshContent correct_xgl(const std::string& path, std::string_view bytes);
/// Like correct_xgl(), for a compressed file (.zgl).
MeshContent correct_zgl(const std::string& path, std::string_view bytes);

}  // namespace octopair::io
