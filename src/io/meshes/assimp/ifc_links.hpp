// IfcLinkReader: finds the relations of elements in the text of an IFC file.
//
// fills      IfcRelFillsElement says which element fills an opening, and IfcRelVoidsElement which element has the opening.
// assembly   IfcRelAggregates, if the whole is an element. Projects, sites, buildings, storeys and spaces are no elements.
// system     IfcRelAssignsToGroup, if the group is an IfcSystem or one of its kinds. Zones are no systems.
#pragma once

#include <string_view>
#include <unordered_map>
#include <unordered_set>
#include <vector>

#include "io/meshes/assimp/ifc_text.hpp"
#include "io/meshes/assimp/step_reader.hpp"

namespace octopair::io {

/// GlobalIds, by the numbers of their instances.
using IfcIds = std::unordered_map<std::string_view, std::string_view>;

class IfcLinkReader {
public:
    /// Adds an instance of the file. The text of the file is borrowed.
    void add(const step::StepInstance& instance);
    /// Returns the links of all instances. Complexity: linear.
    IfcLinks find(const IfcIds& ids) const;

private:
    /// Numbers of two instances.
    struct Numbers {
        std::string_view from, to;
    };

    std::unordered_map<std::string_view, std::string_view> hosts_;  // elements with an opening, by the openings
    std::vector<Numbers> fills_;                                    // from the elements that fill to the openings
    std::vector<Numbers> parts_, members_;                          // to wholes and groups
    std::unordered_set<std::string_view> places_, systems_;         // wholes that are no elements; systems
};

}  // namespace octopair::io
