// IfcModel: an IFC2x3 model by construction, with boxes as elements.
#pragma once

#include <array>
#include <string>
#include <string_view>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

namespace octopair::test {

/// Returns a GlobalId that ends with a word. Requires: at most 22 letters and digits.
inline std::string ifc_id(std::string_view word) { return fmt::format("{:0>22}", word); }

/// A box from one corner to the other.
using IfcBox = std::array<double, 6>;

class IfcModel {
public:
    /// `prefix`: that of the unit of length, for example ".MILLI."; "$" for metres. `project`: the word of the project's GlobalId.
    explicit IfcModel(const std::string& prefix = "$", const std::string& project = "project") {
        add("IFCPERSON($,'n',$,$,$,$,$,$)");
        add("IFCORGANIZATION($,'o',$,$,$)");
        add("IFCPERSONANDORGANIZATION(#1,#2,$)");
        add("IFCAPPLICATION(#2,'1','a','a')");
        add("IFCOWNERHISTORY(#3,#4,$,.ADDED.,$,$,$,0)");
        add(fmt::format("IFCSIUNIT(*,.LENGTHUNIT.,{},.METRE.)", prefix));
        add("IFCUNITASSIGNMENT((#6))");
        add("IFCCARTESIANPOINT((0.,0.,0.))");
        add("IFCAXIS2PLACEMENT3D(#8,$,$)");
        add("IFCGEOMETRICREPRESENTATIONCONTEXT($,'Model',3,1.E-5,#9,$)");
        add(fmt::format("IFCPROJECT('{}',#5,'P',$,$,$,$,(#10),#7)", ifc_id(project)));
        add("IFCLOCALPLACEMENT($,#9)");
        add(fmt::format("IFCBUILDING('{}',#5,'B',$,$,#12,$,$,.ELEMENT.,$,$,$)", ifc_id("building")));
        add(fmt::format("IFCRELAGGREGATES('{}',#5,$,$,#11,(#13))", ifc_id("aggregates")));
        add("IFCDIRECTION((0.,0.,1.))");
    }

    /// Adds an instance, without "#N=" and ";". Returns its number.
    int add(const std::string& instance) {
        data_ += fmt::format("#{}={};\n", ++last_, instance);
        return last_;
    }
    /// Puts the elements into a storey of the building, instead of the building itself.
    void add_storey(const std::string& name) {
        container_ =
            add(fmt::format("IFCBUILDINGSTOREY('{}',#5,'{}',$,$,#12,$,$,.ELEMENT.,0.)", ifc_id("storey"), name));
        add(fmt::format("IFCRELAGGREGATES('{}',#5,$,$,#13,(#{}))", ifc_id("storeys"), container_));
    }
    /// Adds an element with a box as its body, named by `word` or, if given, `name`. Returns its number.
    int add_box(const std::string& type, const std::string& word, const IfcBox& box, const std::string& name = "") {
        const int corner = add(fmt::format("IFCCARTESIANPOINT(({:.9f},{:.9f}))", (box[3] - box[0]) / 2 + box[0],
                                           (box[4] - box[1]) / 2 + box[1]));
        const int axes = add(fmt::format("IFCAXIS2PLACEMENT2D(#{},$)", corner));
        const int profile = add(
            fmt::format("IFCRECTANGLEPROFILEDEF(.AREA.,$,#{},{:.9f},{:.9f})", axes, box[3] - box[0], box[4] - box[1]));
        const int low = add(fmt::format("IFCCARTESIANPOINT((0.,0.,{:.9f}))", box[2]));
        const int place = add(fmt::format("IFCAXIS2PLACEMENT3D(#{},$,$)", low));
        const int solid = add(fmt::format("IFCEXTRUDEDAREASOLID(#{},#{},#15,{:.9f})", profile, place, box[5] - box[2]));
        return add_element(type, word, solid, name);
    }
    /// Adds an element with any item as its body, named like a box. Returns its number.
    int add_element(const std::string& type, const std::string& word, int item, const std::string& name = "") {
        const int body = add(fmt::format("IFCSHAPEREPRESENTATION(#10,'Body','SweptSolid',(#{}))", item));
        const int shape = add(fmt::format("IFCPRODUCTDEFINITIONSHAPE($,$,(#{}))", body));
        const int element = add(fmt::format("{}('{}',#5,'{}',$,$,#12,#{},${})", type, ifc_id(word),
                                            name.empty() ? word : name, shape, more_of(type)));
        contained_.push_back(fmt::format("#{}", element));
        return element;
    }
    /// Adds an element without a shape. Returns its number.
    int add_whole(const std::string& type, const std::string& word) {
        const int element = add(fmt::format("{}('{}',#5,'{}',$,$,#12,$,${})", type, ifc_id(word), word, more_of(type)));
        contained_.push_back(fmt::format("#{}", element));
        return element;
    }
    /// Makes an opening in `host` that `filler` fills.
    void fill(int host, int filler) {
        const int opening = add(fmt::format("IFCOPENINGELEMENT('{}',#5,$,$,$,#12,$,$)", next_id()));
        add(fmt::format("IFCRELVOIDSELEMENT('{}',#5,$,$,#{},#{})", next_id(), host, opening));
        add(fmt::format("IFCRELFILLSELEMENT('{}',#5,$,$,#{},#{})", next_id(), opening, filler));
    }
    /// Makes `parts` the parts of `whole`. They are then no longer direct elements of the building.
    void aggregate(int whole, const std::vector<int>& parts) {
        for (const int part : parts) std::erase(contained_, fmt::format("#{}", part));
        add(fmt::format("IFCRELAGGREGATES('{}',#5,$,$,#{},({}))", next_id(), whole, references(parts)));
    }
    /// Adds a system of `type` with members. Returns its number.
    int add_system(const std::string& type, const std::vector<int>& members) {
        const int system = add(fmt::format("{}('{}',#5,'S',$,$)", type, next_id()));
        add(fmt::format("IFCRELASSIGNSTOGROUP('{}',#5,$,$,({}),$,#{})", next_id(), references(members), system));
        return system;
    }

    std::string text() const {
        return fmt::format(
            "ISO-10303-21;\nHEADER;\nFILE_DESCRIPTION((''),'2;1');\nFILE_NAME('','',(''),(''),'','','');\n"
            "FILE_SCHEMA(('IFC2X3'));\nENDSEC;\nDATA;\n{}"
            "#{}=IFCRELCONTAINEDINSPATIALSTRUCTURE('{}',#5,$,$,({}),#{});\nENDSEC;\nEND-ISO-10303-21;\n",
            data_, last_ + 1, ifc_id("contained"), fmt::join(contained_, ","), container_);
    }

private:
    std::string next_id() { return ifc_id(fmt::format("r{}", last_)); }
    /// Returns the attributes of a type beyond those of all elements.
    static std::string_view more_of(std::string_view type) {
        if (type == "IFCDOOR" || type == "IFCWINDOW") return ",$,$";
        if (type == "IFCSPACE") return ",.ELEMENT.,.INTERNAL.,$";
        return type == "IFCSTAIR" || type == "IFCRAILING" || type == "IFCSLAB" ? ",.NOTDEFINED." : "";
    }
    static std::string references(const std::vector<int>& instances) {
        return fmt::format("#{}", fmt::join(instances, ",#"));
    }

    std::string data_;
    int last_ = 0;
    int container_ = 13;
    std::vector<std::string> contained_;
};

}  // namespace octopair::test
