// Tests that the extension of a file name selects the format.
#include "io/formats.hpp"

#include <gtest/gtest.h>

#include "io/temporary.hpp"

namespace octopair::test {
namespace {

TEST(Formats, OfResults) {
    EXPECT_EQ(io::result_format("a.b/c.npy"), io::ResultFormat::npy);
    EXPECT_EQ(io::result_format("c.csv"), io::ResultFormat::csv);
    EXPECT_EQ(io::result_format("c.JSONL"), io::ResultFormat::jsonl);
    for (const std::string path : {"c", "c.json", "npy", "c.npy.gz", ""}) {
        EXPECT_NE(error_of(ErrorCode::usage, [&] { (void)io::result_format(path); }), "") << path;
    }
    EXPECT_TRUE(io::is_array_file("c.npy"));
    EXPECT_FALSE(io::is_array_file("c.csv"));
    EXPECT_FALSE(io::is_array_file(""));
}

TEST(Formats, OfScenes) {
    EXPECT_EQ(io::scene_format("a.csv/b.NPY"), io::SceneFormat::npy);
    EXPECT_EQ(io::scene_format("a.csv"), io::SceneFormat::csv);
    EXPECT_EQ(io::scene_format("a.json"), io::SceneFormat::json);
    for (const std::string path : {"a", "a.txt", "a.npz", "a.", "npy"}) {
        EXPECT_EQ(io::scene_format(path), io::SceneFormat::unknown) << path;
    }
#ifdef OCTOPAIR_WITH_MESHES
    EXPECT_EQ(io::scene_format("a.glb"), io::SceneFormat::mesh);
#endif
}

TEST(Formats, SomeScenesHaveFurtherFiles) {
    EXPECT_TRUE(io::may_name_files("a.gltf"));
    EXPECT_TRUE(io::may_name_files("a.GLTF"));
    EXPECT_TRUE(io::may_name_files("a.json"));
    EXPECT_FALSE(io::may_name_files("a.glb"));
}

}  // namespace
}  // namespace octopair::test
