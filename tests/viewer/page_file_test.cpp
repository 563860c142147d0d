// Exported pages of a scene in memory.
#include <gtest/gtest.h>

#include "octopair/error.hpp"
#include "support/page_data.hpp"
#include "viewer/fake_finder.hpp"
#include "viewer/scene/page.hpp"
#include "viewer/scene/page_file.hpp"

namespace octopair::test {

namespace {

std::string page_of(FrameSource& source, std::uint64_t most = viewer::max_page_bytes) {
    std::string page;
    write_page(source, [&](std::string_view text) { page += text; }, {most});
    return page;
}

/// Takes the element scripts out of a page, so that what is left is the page itself.
std::string without_data(std::string page) {
    constexpr std::string_view before = "<script type=\"application/octet-stream\"", end = "</script>\n";
    for (std::size_t at; (at = page.find(before)) != std::string::npos;)
        page.erase(at, page.find(end, at) + end.size() - at);
    return page;
}

TEST(PageFile, HasTheAnswersOfTheServer) {
    for (const bool moving : {false, true}) {
        FakeFinder finder(20, moving ? 6 : 1, 70);
        FrameSource source(contents_of(70, moving), finder, 50), exported(contents_of(70, moving), finder, 50);
        source.load({});
        exported.load({});
        if (moving) {
            source.count_frames({}, {});
            exported.count_frames({}, {});
        }
        const auto data = data_of(page_of(exported));
        for (const auto& [address, bytes] : data) {
            if (address == "view.json") continue;
            if (address.starts_with("frame/") && address.ends_with(".json")) {
                Json answer = json_of(source, address);
                answer.erase("seconds");
                EXPECT_EQ(Json::parse(bytes), answer) << address;
                continue;
            }
            const bool table = address.starts_with("collisions/");
            EXPECT_EQ(bytes, body_of(source, address + (table ? "?count=200000&sort=worst" : ""))) << address;
        }
        for (std::uint64_t f = 0; f < finder.frames(); ++f) {
            const std::string number = std::to_string(f);
            for (const std::string& address :
                 {"frame/" + number + ".json", "frame/" + number + ".f32", "pairs/" + number + ".u32",
                  "partners/" + number + ".u32", "levels/" + number + ".u8", "collisions/" + number + ".json",
                  "octants/" + number + ".json", "octants/" + number + "/0.bin"}) {
                EXPECT_TRUE(data.contains(address)) << address;
            }
            EXPECT_EQ(data.contains("began/" + number + ".u32"), moving);
            const std::size_t levels = Json::parse(data.at("octants/" + number + ".json"))["levels"].size();
            for (std::size_t level = 0; level < levels; ++level) {
                EXPECT_TRUE(data.contains("octants/" + number + "/" + std::to_string(level) + ".bin"));
            }
        }
        const Json view = Json::parse(data.at("view.json"));
        EXPECT_EQ(view["has"]["search"], false);
        EXPECT_EQ(view["has"]["near"], false);
        EXPECT_EQ(view["frames"], finder.frames());
    }
}

/// Times differ from run to run.
TEST(PageFile, HasNoTimes) {
    const auto page_with = [](double seconds) {
        FakeFinder finder(23, 3, 60);
        finder.seconds = seconds;
        SceneContents contents = contents_of(60, true);
        contents.facts = {{"seconds.read", seconds}, {"format", 0, "npy"}};
        FrameSource source(std::move(contents), finder);
        source.load({});
        source.count_frames({}, {});
        EXPECT_EQ(json_of(source, "view.json")["summary"]["seconds"]["read"], seconds);
        return page_of(source);
    };
    const std::string page = page_with(0.25);
    EXPECT_TRUE(page == page_with(0.5));
    EXPECT_EQ(Json::parse(data_of(page).at("view.json"))["summary"]["format"], "npy");
}

TEST(PageFile, LeavesOutFramesBeyondTheLimit) {
    FakeFinder finder(21, 20, 60);
    FrameSource whole(contents_of(60, true), finder), part(contents_of(60, true), finder);
    for (FrameSource* source : {&whole, &part}) {
        source->load({});
        source->count_frames({}, {});
    }
    FakeFinder first_finder(21, 1, 60);
    FrameSource first(contents_of(60, true), first_finder);
    first.load({});
    first.count_frames({}, {});
    const std::uint64_t least = page_of(first).size(), most = least + (page_of(whole).size() - least) / 2;
    const std::string page = page_of(part, most);
    EXPECT_LE(page.size(), most);
    const auto data = data_of(page);
    const Json view = Json::parse(data.at("view.json"));
    const std::uint64_t frames = view["frames"];
    EXPECT_GT(frames, 5u);
    EXPECT_LT(frames, 15u);
    EXPECT_EQ(view["notices"][0], "Only the first " + std::to_string(frames) + " of 20 frames are in this file.");
    for (std::uint64_t f = 0; f < 20; ++f) {
        EXPECT_EQ(data.contains("frame/" + std::to_string(f) + ".f32"), f < frames) << f;
    }
    const Json timeline = Json::parse(data.at("timeline.json"));
    EXPECT_EQ(timeline["frames"], frames);
    EXPECT_EQ(timeline["done"], frames);
    EXPECT_EQ(timeline["pairs"].size(), frames);
}

TEST(PageFile, RefusesAFirstFrameBeyondTheLimit) {
    FakeFinder finder(22, 3, 60);
    FrameSource source(contents_of(60, true), finder);
    source.load({});
    bool wrote = false;
    EXPECT_THROW(write_page(source, [&](std::string_view) { wrote = true; }, {1000}), Error);
    EXPECT_FALSE(wrote);
}

TEST(PageFile, TextsOfTheInputCannotBecomePage) {
    FakeFinder finder(23, 1, 40);
    const auto page_with = [&](const std::string& text) {
        SceneContents contents = contents_of(40, false);
        contents.title = text;
        contents.names.assign(40, text);
        contents.notices = {text};
        contents.unit = text;
        FrameSource source(std::move(contents), finder);
        source.load({});
        return page_of(source);
    };
    const std::string hostile = "</script><script>alert(1)</script><!-- data --><!--\"'\xff\xfe\xc3";
    const std::string page = page_with(hostile);
    EXPECT_EQ(without_data(page), without_data(page_with("plain")));
    const Json view = Json::parse(data_of(page).at("view.json"));
    EXPECT_TRUE(view["title"].get<std::string>().starts_with("</script><script>alert(1)"));
}

TEST(PageFile, SceneWithShapes) {
    FakeFinder finder(24, 1, 4);
    SceneContents contents = contents_of(4, false);
    contents.shapes.push_back({"mesh", {100, 0, 0}, {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 1, 2}}});
    contents.geometry = {0, SceneContents::no_shape, 0, 0};
    contents.poses.resize(4);
    contents.poses[2].rows = {{{0, -1, 0, 5}, {1, 0, 0, 6}, {0, 0, 1, 7}}};
    contents.groups = {1, 2, 4, 8};
    FrameSource source(contents, finder);
    source.load({});
    const Json view = json_of(source, "view.json");
    std::vector<std::uint32_t> shown = {0, 1, 2, 3};
    if (const std::string body = body_of(source, "shown.u32"); body != "none") shown = array_of<std::uint32_t>(body);
    const auto geometry = array_of<std::uint32_t>(body_of(source, "geometry.u32"));
    const auto groups = array_of<std::uint32_t>(body_of(source, "groups.u32"));
    const auto poses = array_of<float>(body_of(source, "poses/0.f32"));
    ASSERT_EQ(poses.size(), 48u);
    for (std::size_t row = 0; row < 4; ++row) {
        EXPECT_EQ(geometry[row], contents.geometry[shown[row]]);
        EXPECT_EQ(groups[row], contents.groups[shown[row]]);
        // A vertex of the shape (relative to its centre) is where the pose places the vertex of the whole shape.
        const auto& pose = contents.poses[shown[row]].rows;
        const std::array<double, 3> vertex = {1, 2, 3};
        for (std::size_t axis = 0; axis < 3; ++axis) {
            const double centre = geometry[row] == SceneContents::no_shape ? 0 : 100;
            const double expected = pose[axis][0] * (vertex[0] + centre) + pose[axis][1] * vertex[1] +
                                    pose[axis][2] * vertex[2] + pose[axis][3] - view["origin"][axis].get<double>();
            const float* numbers = &poses[12 * row];
            const double found = double(numbers[axis]) * vertex[0] + double(numbers[3 + axis]) * vertex[1] +
                                 double(numbers[6 + axis]) * vertex[2] + double(numbers[9 + axis]);
            EXPECT_NEAR(found, expected, 1e-4);
        }
    }
    EXPECT_EQ(body_of(source, "shape/0").size(), 36u + 12u);
    EXPECT_EQ(body_of(source, "shape/1"), "none");
    const auto data = data_of(page_of(source));
    for (const char* address : {"geometry.u32", "groups.u32", "shapes.json", "shape/0", "poses/0.f32"}) {
        EXPECT_TRUE(data.contains(address)) << address;
    }
}

}  // namespace

}  // namespace octopair::test
