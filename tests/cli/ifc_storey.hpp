// IfcStorey: an IFC2x3 model of boxes in a storey, whose elements can be changed from version to version.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "io/ifc_model.hpp"

namespace octopair::test {

struct IfcElement {
    std::string id;  ///< GlobalId, 22 characters
    std::string name;
    std::array<double, 3> at;    ///< middle of its bottom, in metres
    std::array<double, 3> size;  ///< in metres
    std::string type = "IFCWALL";
};

struct IfcStorey {
    std::vector<IfcElement> boxes;
    std::string project = "1";
    std::string storey = "EG";
    std::string unit = "$";    ///< prefix of the metre: "$" or, for example, ".MILLI."
    double units_a_metre = 1;  ///< number of units in a metre

    std::string text() const {
        IfcModel model(unit, project);
        model.add_storey(storey);
        for (const IfcElement& element : boxes) {
            IfcBox box;
            for (std::size_t axis = 0; axis < 3; ++axis) {
                const double low = axis == 2 ? element.at[2] : element.at[axis] - element.size[axis] / 2;
                box[axis] = low * units_a_metre;
                box[axis + 3] = (low + element.size[axis]) * units_a_metre;
            }
            model.add_box(element.type, element.id, box, element.name);
        }
        return model.text();
    }
};

}  // namespace octopair::test
