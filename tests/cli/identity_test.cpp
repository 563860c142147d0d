// Tests that collisions keep their identity from one version of a model to the next: renamed elements, storeys and files, swapped inputs.
#include <nlohmann/json.hpp>
#include <set>
#include <sstream>
#include <utility>

#include "cli/ifc_storey.hpp"
#include "cli/program.hpp"

namespace octopair::test {
namespace {

#if defined(OCTOPAIR_WITH_MESHES) && defined(OCTOPAIR_WITH_PIPELINE)

class Identity : public ProgramTest {
protected:
    /// A long wall that meets two cross walls and a pipe.
    static IfcStorey building() {
        return {{{"00000000000000000000W1", "North", {0, 0, 0}, {10, 0.2, 3}},
                 {"00000000000000000000W2", "West", {-3, 1, 0}, {0.2, 3, 3}},
                 {"00000000000000000000W3", "East", {3, 1, 0}, {0.2, 3, 3}},
                 {"00000000000000000000P1", "Pipe", {0, 0, 1}, {0.1, 1, 0.1}, "IFCBUILDINGELEMENTPROXY"}}};
    }
    void write(const std::string& name, const IfcStorey& model) const { write_file(file(name), model.text()); }
    /// Finds the collisions of `inputs`, compared with old.jsonl. Returns the changes from the summary.
    std::string changes(const std::string& inputs) const {
        const Outcome outcome = run("detect " + inputs + " --baseline old.jsonl --output new.jsonl");
        EXPECT_EQ(outcome.status, 0) << outcome.err;
        const std::size_t begin = outcome.err.find("changes     ") + 12;
        return outcome.err.substr(begin, outcome.err.find('\n', begin) - begin);
    }
    void make_old(const std::string& inputs) const {
        ASSERT_EQ(run("detect " + inputs + " --output old.jsonl --quiet").status, 0);
    }
    std::vector<nlohmann::json> rows(const std::string& name) const {
        std::vector<nlohmann::json> rows;
        std::istringstream lines(content(name));
        for (std::string line; std::getline(lines, line);) rows.push_back(nlohmann::json::parse(line));
        return rows;
    }
};

TEST_F(Identity, RenamedElementsAndStoreysAreTheSame) {
    write("v1.ifc", building());
    make_old("v1.ifc");
    IfcStorey wall = building();
    wall.boxes[0].name = "North facade";
    write("v2.ifc", wall);
    EXPECT_EQ(changes("v2.ifc"), "0 new, 3 same, 0 gone");
    IfcStorey storey = building();
    storey.storey = "Ground floor";
    write("v2.ifc", storey);
    EXPECT_EQ(changes("v2.ifc"), "0 new, 3 same, 0 gone");
    EXPECT_EQ(rows("new.jsonl")[0]["key"],
              "0000000000000000000001/00000000000000000000W1 | 0000000000000000000001/00000000000000000000W2");
    // A new number of an element changes nothing, either.
    std::swap(wall.boxes[0], wall.boxes[3]);
    write("v2.ifc", wall);
    EXPECT_EQ(changes("v2.ifc"), "0 new, 3 same, 0 gone");
    wall.boxes[1].at[0] = 40;
    write("v2.ifc", wall);
    EXPECT_EQ(changes("v2.ifc"), "0 new, 2 same, 1 gone");
}

TEST_F(Identity, RenamedFilesAreTheSame) {
    write_file(
        file("a.obj"),
        "o flat\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\no through\nv 0.2 0.2 -1\nv 0.2 0.2 1\nv 0.3 0.2 1\nf 4 5 6\n");
    write_file(file("s.stl"),
               "solid s\nfacet normal 0 0 0\nouter loop\nvertex 0 0 0.5\nvertex 1 0 0.5\nvertex 0 1 0.5\n"
               "endloop\nendfacet\nendsolid\n");
    write_file(
        file("a.gltf"),
        R"({"asset":{"version":"2.0"},"scenes":[{"nodes":[0,1]}],"nodes":[{"name":"a.gltf","mesh":0},)"
        R"({"name":"turned","mesh":0,"rotation":[0.7071067811865476,0,0,0.7071067811865476],"translation":[0,0.1,-0.2]}],)"
        R"("meshes":[{"primitives":[{"attributes":{"POSITION":0}}]}],)"
        R"("accessors":[{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3","min":[0,0,0],"max":[1,1,0]}],)"
        R"("bufferViews":[{"buffer":0,"byteLength":36}],"buffers":[{"byteLength":36,)"
        R"("uri":"data:application/octet-stream;base64,AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAA"}]})");
    write("a.ifc", building());
    const std::pair<const char*, const char*> cases[] = {
        {"a.obj", "1"}, {"a.obj s.stl", "2"}, {"a.gltf", "1"}, {"a.ifc", "3"}, {"a.obj --objects triangle", "1"}};
    for (const auto& [inputs, count] : cases) {
        SCOPED_TRACE(inputs);
        make_old(inputs);
        ASSERT_EQ(shell("for f in a.obj s.stl a.gltf a.ifc; do cp $f renamed.$f; done").status, 0);
        std::string renamed = inputs;
        for (const char* name : {"a.obj", "s.stl", "a.gltf", "a.ifc"}) {
            if (const std::size_t at = renamed.find(name); at != std::string::npos) renamed.insert(at, "renamed.");
        }
        EXPECT_EQ(changes(renamed), std::string("0 new, ") + count + " same, 0 gone");
    }
}

TEST_F(Identity, SwappedInputsAreTheSame) {
    IfcStorey pipes = building(), walls = building();
    pipes.boxes.erase(pipes.boxes.begin(), pipes.boxes.begin() + 3);
    pipes.project = "00000000000000000000P0";
    walls.boxes.pop_back();
    write("walls.ifc", walls);
    write("pipes.ifc", pipes);
    make_old("walls.ifc --against pipes.ifc");
    EXPECT_EQ(changes("pipes.ifc --against walls.ifc"), "0 new, 1 same, 0 gone");
    const nlohmann::json row = rows("new.jsonl")[0];
    EXPECT_EQ(row["a_file"], "pipes.ifc");
    EXPECT_EQ(row["b_file"], "walls.ifc");
    make_old("walls.ifc pipes.ifc");
    EXPECT_EQ(changes("pipes.ifc walls.ifc"), "0 new, 3 same, 0 gone");
    ASSERT_EQ(run("detect walls.ifc pipes.ifc --output r.csv --quiet").status, 0);
    EXPECT_TRUE(has_text(content("r.csv"), ",a_file,b_file\n")) << content("r.csv");
    EXPECT_TRUE(has_text(content("r.csv"), ",walls.ifc,pipes.ifc\n")) << content("r.csv");
    ASSERT_EQ(run("detect walls.ifc --output r.csv --quiet").status, 0);
    EXPECT_FALSE(has_text(content("r.csv"), "_file")) << "one input has no column for its file";
}

TEST_F(Identity, CopiesWithOneIdStayApart) {
    IfcStorey copied = building();
    copied.boxes[2].id = copied.boxes[1].id;
    write("v1.ifc", copied);
    make_old("v1.ifc");
    std::set<std::string> keys;
    for (const auto& row : rows("old.jsonl")) keys.insert(row["key"]);
    EXPECT_EQ(keys.size(), 3u);
    EXPECT_EQ(changes("v1.ifc"), "0 new, 3 same, 0 gone");
    copied.boxes[2].at[0] = 40;
    write("v1.ifc", copied);
    EXPECT_EQ(changes("v1.ifc"), "0 new, 2 same, 1 gone");
}

/// Results of octopair 0.2 have no keys. Their rows are matched by name.
TEST_F(Identity, ResultsWithoutKeysAreBaselines) {
    write("v1.ifc", building());
    make_old("v1.ifc");
    ASSERT_EQ(shell(R"(sed -i 's/"key":"[^"]*",//' old.jsonl; ! grep key old.jsonl)").status, 0);
    EXPECT_EQ(changes("v1.ifc"), "0 new, 3 same, 0 gone");
    IfcStorey renamed = building();
    renamed.boxes[1].name = "West facade";
    write("v1.ifc", renamed);
    EXPECT_EQ(changes("v1.ifc"), "1 new, 2 same, 1 gone");
}

#endif

}  // namespace
}  // namespace octopair::test
