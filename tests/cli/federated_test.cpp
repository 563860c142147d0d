// Tests building models: elements that are lost, rules by relations, units and places of several models.
#include <nlohmann/json.hpp>

#include "cli/program.hpp"
#include "io/ifc_model.hpp"

namespace octopair::test {
namespace {

#if defined(OCTOPAIR_WITH_MESHES) && defined(OCTOPAIR_WITH_PIPELINE)

using nlohmann::json;

class Federated : public ProgramTest {
protected:
    void save(const std::string& name, const IfcModel& model) const { write_file(file(name), model.text()); }
};

TEST_F(Federated, LostElementsAreTold) {
    IfcModel model;
    model.add_box("IFCWALL", "wall", {0, 0, 0, 4, 1, 3});
    model.add_box("IFCBEAM", "beam", {3, 0, 2, 8, 1, 4});
    model.add_element("IFCBEAM", "block", model.add("IFCBLOCK(#9,1.,1.,1.)"));
    model.add_element("IFCSPACE", "room", model.add("IFCBLOCK(#9,1.,1.,1.)"));
    save("a.ifc", model);
    const std::string warning = "1 of 3 elements with geometry were not read: 1 IFCBEAM, the first is " +
                                ifc_id("block") + " ('block'). Export the model as glTF or OBJ\n";
    const Outcome outcome = run("detect a.ifc --stats s.json -o p.csv");
    EXPECT_TRUE(has_text(outcome.err,
                         "\nelements    2 of 3 with geometry were read; left out on purpose: IFCSPACE 1\n"
                         "warning     a.ifc: " +
                             warning));
    const json elements = json::parse(content("s.json"))["elements"];
    EXPECT_EQ(elements["with_geometry"], 3);
    EXPECT_EQ(elements["read"], 2);
    ASSERT_EQ(elements["lost"].size(), 1u);
    EXPECT_EQ(elements["lost"][0]["file"], "a.ifc");
    EXPECT_EQ(elements["lost"][0]["type"], "IFCBEAM");
    EXPECT_EQ(elements["lost"][0]["count"], 1);
    EXPECT_EQ(elements["lost"][0]["first"], ifc_id("block") + " ('block')");
    EXPECT_EQ(elements["left_out"]["IFCSPACE"], 1);
    const std::string info = run("info a.ifc").out;
    EXPECT_TRUE(has_text(info, "elements         2 of 3 with geometry were read\n"));
    EXPECT_TRUE(has_text(info, "not read         IFCSPACE (1)\n"));
    EXPECT_TRUE(has_text(info, "warning          " + warning));
}

TEST_F(Federated, ElementsOfAllInputsAreCounted) {
    IfcModel model;
    model.add_box("IFCWALL", "wall", {0, 0, 0, 4, 1, 3});
    save("a.ifc", model);
    save("b.ifc", model);
    write_file(file("c.obj"), "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
    EXPECT_TRUE(
        has_text(run("detect a.ifc b.ifc c.obj -o p.csv").err, "\nelements    2 of 2 with geometry were read\n"));
    EXPECT_TRUE(
        has_text(run("detect a.ifc --against b.ifc -o p.csv").err, "\nelements    2 of 2 with geometry were read\n"));
    EXPECT_FALSE(has_text(run("detect c.obj -o p.csv").err, "elements"));
}

#endif

}  // namespace
}  // namespace octopair::test
