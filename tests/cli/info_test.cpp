// Tests `octopair info FILE`, and the messages about files that are not what they seem.
#include <cmath>

#include "cli/program.hpp"

namespace octopair::test {
namespace {

class Info : public ProgramTest {
protected:
    /// Writes an OBJ file with a closed block and an open triangle.
    void save_obj(const std::string& name) const {
        std::string text = "o block\n";
        for (int i = 0; i < 8; ++i)
            text += "v " + std::to_string(i & 1) + ' ' + std::to_string(i >> 1 & 1) + ' ' + std::to_string(i >> 2 & 1) +
                    '\n';
        text += "f 1 3 4 2\nf 5 6 8 7\nf 1 2 6 5\nf 3 7 8 4\nf 1 5 7 3\nf 2 4 8 6\no open\nf 1 2 3\n";
        write_file(file(name), text);
    }
};

TEST_F(Info, OfTheProgramWithoutFiles) {
    const Outcome outcome = run("info");
    EXPECT_EQ(outcome.status, 0);
    EXPECT_TRUE(has_text(outcome.out, "\nengines          local"));
}

TEST_F(Info, OfBoxesAndSpheres) {
    save_boxes("a.npy", {0, 1});
    EXPECT_EQ(run("info a.npy").out,
              "file             a.npy\nformat           NumPy\nversion          1.0\nunit             not known\n"
              "axes             not known\nobjects          2 boxes\nbounds           0 0 0 to 2 1 1\n"
              "not read         nothing that octopair knows of\n");
    write_file(file("s.npy"), npy_of(io::NpyType::float64, {1, 4}, std::vector<double>{0, 0, 0, 1}));
    EXPECT_TRUE(has_text(run("info s.npy").out, "objects          1 sphere\nbounds           -1 -1 -1 to 1 1 1\n"));
    write_file(file("m.csv"), npy_of(io::NpyType::float32, {2, 1, 6}, std::vector<float>(12, 0)));
    const std::string moving = run("info m.csv").out;
    EXPECT_TRUE(has_text(moving, "frames           2\n"));
    EXPECT_TRUE(has_text(moving, "warning          is NumPy, not CSV as its name says; it is read as NumPy\n"));
    write_file(file("empty.csv"), "");
    EXPECT_TRUE(has_text(run("info empty.csv").out, "warning          has no object\n"));
}

TEST_F(Info, RefusesWhatCannotBeRead) {
    write_file(file("a.npy"), "version https://git-lfs.github.com/spec/v1\n");
    const Outcome pointer = run("info a.npy");
    EXPECT_EQ(pointer.status, 3);
    EXPECT_EQ(pointer.out, "");
    EXPECT_EQ(pointer.err, "octopair: a.npy: is a Git LFS pointer, not the file itself; run `git lfs pull`\n");
    EXPECT_EQ(run("info missing.npy").status, 4);
}

TEST_F(Info, RefusesWrongBoxesAsDetectDoes) {
    write_file(file("a.npy"),
               npy_of(io::NpyType::float64, {2, 6}, std::vector<double>{0, 0, 0, 1, 1, 1, 0, 3, 0, 1, 2, 1}));
    write_file(file("nan.npy"), npy_of(io::NpyType::float32, {1, 6}, std::vector<float>{0, NAN, 0, 1, 1, 1}));
    write_file(file("a.csv"), "0,0,0,1,1,1\n0,0,5,1,1,1\n");
    write_file(file("moving.npy"),
               npy_of(io::NpyType::float32, {2, 1, 6}, std::vector<float>{0, 0, 0, 1, 1, 1, 2, 0, 0, 1, 1, 1}));
    for (const std::string name : {"a.npy", "nan.npy", "a.csv", "moving.npy"}) {
        const Outcome info = run("info " + name), detect = run("detect " + name + " --quiet");
        EXPECT_EQ(info.status, 3) << name;
        EXPECT_EQ(info.out, "") << name;
        EXPECT_EQ(info.err, detect.err) << name;
    }
    EXPECT_EQ(run("info a.npy").err, "octopair: a.npy: object 1: min y 3 is above max y 2\n");
}

TEST_F(Info, RulesAndBaselinesMayBeWrappedToo) {
    save_boxes("a.npy", {0, 1});
    write_file(file("rules.json"), "\x1f\x8b\x08 ");
    write_file(file("old.jsonl"), "<html>");
    EXPECT_TRUE(has_text(run("detect a.npy --stage pairs --exclude rules.json").err,
                         "rules.json: is compressed with gzip; unpack it"));
#ifdef OCTOPAIR_WITH_PIPELINE
    write_file(file("s.json"), R"({"objects": [{"shape": {"type": "sphere", "radius": 1}}]})");
    EXPECT_TRUE(has_text(run("detect s.json --baseline old.jsonl").err, "old.jsonl: is an HTML page"));
#endif
}

TEST_F(Info, BoxesHaveNoTriangles) {
    save_boxes("a.npy", {0, 1});
    write_file(file("a.csv"), "0,0,0,1,1,1\n");
    for (const std::string inputs : {"a.npy", "a.csv", "a.csv --against a.npy", "a.npy --stage pairs"}) {
        const Outcome outcome = run("detect " + inputs + " --objects triangle");
        EXPECT_EQ(outcome.status, 2) << inputs;
        EXPECT_TRUE(has_text(outcome.err, "has only boxes, no triangles"));
    }
}

#if defined(OCTOPAIR_WITH_MESHES) && defined(OCTOPAIR_WITH_PIPELINE)
TEST_F(Info, OfMeshesAndShapes) {
    save_obj("a.obj");
    EXPECT_EQ(run("info a.obj").out,
              "file             a.obj\nformat           OBJ\nunit             not known\naxes             not known\n"
              "objects          2 meshes\nvertices         11\ntriangles        13\nopen meshes      1: open\n"
              "bounds           0 0 0 to 1 1 1\nnot read         nothing that octopair knows of\n");
    write_file(
        file("s.json"),
        R"({"objects": [{"shape": {"type": "sphere", "radius": 1}}, {"shape": {"type": "mesh", "file": "a.obj"}}]})");
    const std::string both = run("info s.json a.obj").out;
    EXPECT_TRUE(has_text(both, "objects          1 sphere, 1 mesh\n"));
    EXPECT_TRUE(has_text(both, "\n\nfile             a.obj\n"));
    write_file(file("line.obj"), "v 0 0 0\nv 1 0 0\nl 1 2\n");
    EXPECT_TRUE(has_text(run("info line.obj").out, "not read         1 object has only points or lines\n"));
}

TEST_F(Info, OfAFormatOfAssimp) {
    write_file(file("a.raw"), "part\n0 0 0 1 0 0 0 1 0\n");
    const std::string text = run("info a.raw").out;
    EXPECT_TRUE(has_text(text, "format           raw triangles, read by Assimp (octopair does not vouch for it)\n"));
    const Outcome outcome = run("detect a.raw --output p.csv");
    EXPECT_EQ(outcome.status, 0);
    EXPECT_TRUE(
        has_text(outcome.err,
                 "warning     a.raw: Assimp reads raw triangles; octopair does not vouch for it: check the number of "
                 "objects and the bounds\n"));
}

TEST_F(Info, WarningsOfFilesThatASceneNames) {
    write_file(file("part.raw"), "part\n0 0 0 1 0 0 0 1 0\n");
    save_obj("obj.stl");
    write_file(file("s.json"), R"({"objects": [{"shape": {"type": "mesh", "file": "part.raw"}},
{"shape": {"type": "mesh", "file": "obj.stl"}}]})");
    const std::string text = run("info s.json").out;
    EXPECT_TRUE(has_text(text, "warning          part.raw: Assimp reads raw triangles; octopair does not vouch"));
    EXPECT_TRUE(has_text(text, "warning          obj.stl: is OBJ, not STL as its name says; it is read as OBJ\n"));
}

/// Assimp crashes on a body of a type that IFC2x3 does not have.
TEST_F(Info, ACrashOfAssimpNamesItsCause) {
    write_file(file("a.ifc"), R"(ISO-10303-21;
HEADER;
FILE_SCHEMA(('IFC4'));
ENDSEC;
DATA;
#6=IFCSIUNIT(*,.LENGTHUNIT.,$,.METRE.);
#7=IFCUNITASSIGNMENT((#6));
#8=IFCCARTESIANPOINT((0.,0.,0.));
#11=IFCAXIS2PLACEMENT3D(#8,$,$);
#12=IFCGEOMETRICREPRESENTATIONCONTEXT($,'Model',3,1.E-5,#11,$);
#13=IFCPROJECT('0000000000000000000001',$,'P',$,$,$,$,(#12),#7);
#14=IFCLOCALPLACEMENT($,#11);
#17=IFCBUILDING('0000000000000000000003',$,'S',$,$,#14,$,$,.ELEMENT.,$,$,$);
#18=IFCRELAGGREGATES('0000000000000000000004',$,$,$,#13,(#17));
#20=IFCCARTESIANPOINTLIST3D(((0.,0.,0.),(1.,0.,0.),(0.,1.,0.)));
#21=IFCTRIANGULATEDFACESET(#20,$,.F.,((1,2,3)),$);
#22=IFCSHAPEREPRESENTATION(#12,'Body','Tessellation',(#21));
#23=IFCPRODUCTDEFINITIONSHAPE($,$,(#22));
#24=IFCBUILDINGELEMENTPROXY('0000000000000000000T01',$,'a',$,$,#14,#23,$,$);
#25=IFCRELCONTAINEDINSPATIALSTRUCTURE('0000000000000000000006',$,$,$,(#24),#17);
ENDSEC;
END-ISO-10303-21;
)");
    const Outcome outcome = run("detect a.ifc");
    EXPECT_EQ(outcome.status, 3);
    EXPECT_TRUE(
        has_text(outcome.err,
                 "the file is IFC4 and has 1 IfcTriangulatedFaceSet, 1 IfcCartesianPointList3D; Assimp knows only the "
                 "types of IFC2x3. Install octopair-ifc, or export the model as IFC2x3, glTF or OBJ\n"));
}
#endif

}  // namespace
}  // namespace octopair::test
