// IFC elements: their descriptions in the names of Assimp's nodes, and their names in the text of the file (STEP, ISO 10303-21).
// The latter are needed, because Assimp loses encoded letters: "B\X2\00FC\X0\ro", for Büro, becomes "Bro".
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <unordered_map>

namespace octopair::io {

/// An IFC element, as the name of its node describes it: TYPE_NAME_GLOBALID. Borrows from that name.
struct IfcElement {
    std::string_view type, name, id;  ///< `name` is empty if the element has none
};

/// Parses the name of a node of an IFC file. Returns nothing if the node is not an element.
std::optional<IfcElement> parse_ifc_element(std::string_view node_name);

/// Maps the GlobalId of an element to its name in UTF-8. Elements without a name are missing.
using IfcNames = std::unordered_map<std::string, std::string>;

/// Returns the names of all elements: instances whose first attribute is a text of 22 characters, and whose third is a text. Text
/// that is not STEP gives no names. Complexity: linear.
IfcNames find_ifc_names(std::string_view step);

/// Returns a text of a STEP file in UTF-8. Decodes '', \\, \S\, \X\, \X2\ and \X4\. Keeps what is not a
/// valid code.
std::string decode_step_text(std::string_view text);

}  // namespace octopair::io
