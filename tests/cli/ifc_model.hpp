// Writes small IFC2x3 models: boxes in a storey of a building.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include <fmt/format.h>

namespace octopair::test {

struct IfcBox {
    std::string id;  ///< GlobalId, 22 characters
    std::string name;
    std::array<double, 3> at;    ///< middle of its bottom, in metres
    std::array<double, 3> size;  ///< in metres
    std::string type = "IFCWALL";
};

struct IfcModel {
    std::vector<IfcBox> boxes;
    std::string project = "0000000000000000000001";
    std::string storey = "EG";
    std::string unit = "$";    ///< prefix of the metre: "$" or, for example, ".MILLI."
    double units_a_metre = 1;  ///< number of units in a metre

    std::string text() const {
        std::string text =
            "ISO-10303-21;\nHEADER;\nFILE_DESCRIPTION((''),'2;1');\nFILE_NAME('','',(''),(''),'','','');\n"
            "FILE_SCHEMA(('IFC2X3'));\nENDSEC;\nDATA;\n"
            "#25=IFCPERSON($,'n',$,$,$,$,$,$);\n#26=IFCORGANIZATION($,'o',$,$,$);\n"
            "#27=IFCPERSONANDORGANIZATION(#25,#26,$);\n#28=IFCAPPLICATION(#26,'1','a','a');\n"
            "#30=IFCOWNERHISTORY(#27,#28,$,.ADDED.,$,$,$,0);\n";
        text += fmt::format("#1=IFCSIUNIT(*,.LENGTHUNIT.,{},.METRE.);\n", unit);
        text +=
            "#2=IFCUNITASSIGNMENT((#1));\n#3=IFCCARTESIANPOINT((0.,0.,0.));\n#4=IFCAXIS2PLACEMENT3D(#3,$,$);\n"
            "#5=IFCGEOMETRICREPRESENTATIONCONTEXT($,'Model',3,1.E-5,#4,$);\n";
        text += fmt::format("#6=IFCPROJECT('{}',#30,'P',$,$,$,$,(#5),#2);\n", project);
        text +=
            "#7=IFCLOCALPLACEMENT($,#4);\n"
            "#8=IFCBUILDING('0000000000000000000002',#30,'H',$,$,#7,$,$,.ELEMENT.,$,$,$);\n";
        text +=
            fmt::format("#9=IFCBUILDINGSTOREY('0000000000000000000003',#30,'{}',$,$,#7,$,$,.ELEMENT.,0.);\n", storey);
        text +=
            "#10=IFCRELAGGREGATES('0000000000000000000004',#30,$,$,#6,(#8));\n"
            "#11=IFCRELAGGREGATES('0000000000000000000005',#30,$,$,#8,(#9));\n"
            "#12=IFCCARTESIANPOINT((0.,0.));\n#13=IFCAXIS2PLACEMENT2D(#12,$);\n#15=IFCDIRECTION((0.,0.,1.));\n";
        std::string elements;
        std::uint32_t number = 100;
        for (const IfcBox& box : boxes) {
            text += box_text(box, number);
            elements += fmt::format("{}#{}", elements.empty() ? "" : ",", number + 7);
            number += 10;
        }
        text +=
            fmt::format("#24=IFCRELCONTAINEDINSPATIALSTRUCTURE('0000000000000000000008',#30,$,$,({}),#9);\n", elements);
        return text + "ENDSEC;\nEND-ISO-10303-21;\n";
    }

private:
    std::string box_text(const IfcBox& box, std::uint32_t n) const {
        const auto length = [this](double metres) { return fmt::format("{:.6f}", metres * units_a_metre); };
        std::string text = fmt::format("#{}=IFCRECTANGLEPROFILEDEF(.AREA.,$,#13,{},{});\n", n, length(box.size[0]),
                                       length(box.size[1]));
        text += fmt::format("#{}=IFCEXTRUDEDAREASOLID(#{},#4,#15,{});\n", n + 1, n, length(box.size[2]));
        text += fmt::format("#{}=IFCSHAPEREPRESENTATION(#5,'Body','SweptSolid',(#{}));\n", n + 2, n + 1);
        text += fmt::format("#{}=IFCPRODUCTDEFINITIONSHAPE($,$,(#{}));\n", n + 3, n + 2);
        text += fmt::format("#{}=IFCCARTESIANPOINT(({},{},{}));\n", n + 4, length(box.at[0]), length(box.at[1]),
                            length(box.at[2]));
        text += fmt::format("#{}=IFCAXIS2PLACEMENT3D(#{},$,$);\n#{}=IFCLOCALPLACEMENT(#7,#{});\n", n + 5, n + 4, n + 6,
                            n + 5);
        return text +
               fmt::format("#{}={}('{}',#30,'{}',$,$,#{},#{},$);\n", n + 7, box.type, box.id, box.name, n + 6, n + 3);
    }
};

}  // namespace octopair::test
