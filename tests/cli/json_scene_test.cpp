// Tests JSON scenes with the program: the result holds the pairs of the boxes of the shapes.
#include "cli/program.hpp"

namespace octopair::test {
namespace {

class JsonSceneProgram : public ProgramTest {};

#ifdef OCTOPAIR_WITH_PIPELINE
const std::string balls_on_a_floor = R"({
    "shapes": {"ball": {"type": "sphere", "radius": 1}},
    "objects": [
        {"name": "left", "shape": "ball"},
        {"name": "right", "shape": "ball", "position": [1.9, 0, 0]},
        {"name": "far", "shape": "ball", "position": [9, 0, 5]},
        {"name": "floor", "shape": {"type": "plane", "normal": [0, 0, 1], "offset": -1}}]})";

TEST_F(JsonSceneProgram, PairsOfBoxes) {
    write_file(file("s.json"), balls_on_a_floor);
    ASSERT_EQ(run("detect s.json --stage pairs --quiet --output p.jsonl").status, 0);
    EXPECT_EQ(content("p.jsonl"), R"({"a":0,"b":1,"a_name":"left","b_name":"right"}
{"a":0,"b":3,"a_name":"left","b_name":"floor"}
{"a":1,"b":3,"a_name":"right","b_name":"floor"}
)");
}

TEST_F(JsonSceneProgram, PlanesReachTheOtherSet) {
    write_file(file("s.json"), balls_on_a_floor);
    write_file(file("b.csv"), "20,20,-2,21,21,0\n");
    EXPECT_EQ(run("detect s.json --against b.csv --quiet").out, "a,b\n3,0\n");
    EXPECT_EQ(run("detect b.csv --against s.json --quiet").out, "a,b\n0,3\n");
}

TEST_F(JsonSceneProgram, RefusesInOneLine) {
    write_file(file("s.json"), balls_on_a_floor);
    write_file(file("b.csv"), "0,0,0,1,1,1\n");
    write_file(file("wrong.json"), R"({"objects":[{"shape":{"type":"sphere","radius":-1}}]})");
    const Outcome mixed = run("detect s.json b.csv --quiet"), wrong = run("detect wrong.json --quiet");
    EXPECT_EQ(mixed.status, 3);
    EXPECT_EQ(mixed.err,
              "octopair: b.csv: has only boxes, but s.json has shapes; the files of one set must have the same\n");
    EXPECT_EQ(wrong.status, 3);
    EXPECT_EQ(wrong.err, "octopair: wrong.json: object 0: shape: radius: -1 is not a number > 0\n");
}
#endif

}  // namespace
}  // namespace octopair::test
