// The schema of an IFC file, and types that Assimp does not know.
#include "io/meshes/assimp/ifc_text.hpp"

#include <algorithm>
#include <array>
#include <cstdint>

#include <fmt/format.h>

#include "base/memory.hpp"
#include "io/files/input_file.hpp"
#include "io/files/letter_case.hpp"
#include "io/formats/format_choice.hpp"

namespace octopair::io {

namespace {

constexpr std::array<std::string_view, 28> new_types = {"IfcTriangulatedFaceSet",
                                                        "IfcTriangulatedIrregularNetwork",
                                                        "IfcPolygonalFaceSet",
                                                        "IfcCartesianPointList3D",
                                                        "IfcCartesianPointList2D",
                                                        "IfcIndexedPolyCurve",
                                                        "IfcAdvancedBrep",
                                                        "IfcAdvancedBrepWithVoids",
                                                        "IfcAdvancedFace",
                                                        "IfcBSplineSurfaceWithKnots",
                                                        "IfcRationalBSplineSurfaceWithKnots",
                                                        "IfcBSplineCurveWithKnots",
                                                        "IfcRationalBSplineCurveWithKnots",
                                                        "IfcCylindricalSurface",
                                                        "IfcSphericalSurface",
                                                        "IfcToroidalSurface",
                                                        "IfcExtrudedAreaSolidTapered",
                                                        "IfcRevolvedAreaSolidTapered",
                                                        "IfcFixedReferenceSweptAreaSolid",
                                                        "IfcSweptDiskSolidPolygonal",
                                                        "IfcSectionedSolidHorizontal",
                                                        "IfcDirectrixDerivedReferenceSweptAreaSolid",
                                                        "IfcSeamCurve",
                                                        "IfcIntersectionCurve",
                                                        "IfcAlignmentCurve",
                                                        "IfcGradientCurve",
                                                        "IfcPolynomialCurve",
                                                        "IfcClothoid"};

/// Returns the number of instances of a type: of "=TYPE(", with letters of any case. `upper`: name of the type in capitals.
std::uint64_t count_type(std::string_view step, const std::string& upper) {
    std::uint64_t count = 0;
    for (std::size_t at = step.find(upper); at != std::string_view::npos; at = step.find(upper, at + upper.size())) {
        const std::size_t before = step.substr(0, at).find_last_not_of(" \t\r\n");
        count += before != std::string_view::npos && step[before] == '=';
    }
    return count;
}

std::string read_step(const std::string& path) {
    const InputFile file(path);
    std::string text(std::size_t(file.size()), '\0');
    file.read(0, std::as_writable_bytes(std::span(text)));
    return text;
}

}  // namespace

std::string ifc_schema(std::string_view step) {
    const std::size_t schema = step.find("FILE_SCHEMA");
    if (schema == std::string_view::npos) return {};
    const std::size_t begin = step.find('\'', schema);
    if (begin == std::string_view::npos) return {};
    const std::size_t end = step.find('\'', begin + 1);
    if (end == std::string_view::npos || end - begin > 40) return {};
    return std::string(step.substr(begin + 1, end - begin - 1));
}

std::string types_beyond_ifc2x3(std::string_view step) {
    std::string types;
    for (const std::string_view type : new_types) {
        const std::uint64_t count = count_type(step, in_upper_case(type) + "(");
        if (count > 0) types += fmt::format("{}{} {}", types.empty() ? "" : ", ", count, type);
    }
    return types;
}

std::string ifc_remedy(const std::string& path) {
    if (format_ending(path) != ".ifc") return {};
    const std::string step = read_step(path), types = types_beyond_ifc2x3(step), schema = ifc_schema(step);
    if (!types.empty()) {
        return fmt::format(
            "the file is {} and has {}; Assimp knows only the types of IFC2x3. Install octopair-ifc, or export the "
            "model as "
            "IFC2x3, glTF or OBJ",
            schema.empty() ? "IFC" : schema, types);
    }
    if (in_upper_case(schema) == "IFC2X3")
        return "install octopair-ifc, or export the model anew as IFC2x3, glTF or OBJ";
    return fmt::format(
        "the file is {}, and Assimp knows only IFC2x3. Install octopair-ifc, or export the model as IFC2x3, glTF or "
        "OBJ",
        schema);
}

}  // namespace octopair::io
