// FrameSource on a scene in memory.
#include <gtest/gtest.h>

#include <set>
#include <thread>

#include "octopair/error.hpp"
#include "support/errors.hpp"
#include "viewer/fake_finder.hpp"
#include "viewer/scene/frame_source.hpp"
#include "viewer/shown_frames.hpp"

namespace octopair::test {

namespace {

using namespace std::chrono_literals;

TEST(FrameSource, LoadsTheFirstFrame) {
    FakeFinder finder(1, 1, 50);
    FrameSource source(contents_of(50, false), finder);
    EXPECT_TRUE(source.loading());
    EXPECT_EQ(Json::parse(source.greeting("")[0])["event"], "progress");
    std::vector<double> progress;
    source.load([&](double done) { progress.push_back(done); });
    EXPECT_FALSE(source.loading());
    EXPECT_EQ(progress, std::vector<double>{0.5});
    EXPECT_EQ(Json::parse(source.greeting("")[0])["event"], "ready");
    EXPECT_TRUE(source.greeting("scene/7").empty());
    const Json view = json_of(source, "view.json");
    EXPECT_EQ(view["kind"], "scene");
    EXPECT_EQ(view["objects"], 50);
    EXPECT_EQ(view["shown"], 50);
    EXPECT_EQ(view["frames"], 1);
    EXPECT_EQ(view["summary"]["pairs"], finder.pairs(0).size());
    EXPECT_EQ(view["summary"]["seconds"]["detect"], 0.5);
    EXPECT_EQ(view["has"]["events"], false);
    EXPECT_EQ(view["has"]["near"], false);
    EXPECT_EQ(view["notices"].size(), 0u);
    EXPECT_EQ(pairs_of(source, "pairs/0.u32"), finder.pairs(0));
    EXPECT_EQ(body_of(source, "timeline.json"), "none");
    EXPECT_EQ(body_of(source, "began/0.u32"), "none");
}

TEST(FrameSource, UnknownAddressesHaveNoData) {
    FakeFinder finder(2, 3, 20);
    FrameSource source(contents_of(20, true), finder);
    source.load({});
    for (const std::string address : {"x",
                                      "frame",
                                      "frame/",
                                      "frame/0",
                                      "frame/3.json",
                                      "frame/-1.json",
                                      "frame/x.json",
                                      "frame/0.JSON",
                                      "frame/18446744073709551616.json",
                                      "frame/0.json/x",
                                      "/frame/0.json",
                                      "octants/0/22.bin",
                                      "octants/0/-1.bin",
                                      "octants/0/x.bin",
                                      "octants/0/0",
                                      "octants/3/0.bin",
                                      "object/0/20.json",
                                      "object/0/-1.json",
                                      "object/0/4294967296.json",
                                      "object/0/1.bin",
                                      "object/0/1",
                                      "object/0",
                                      "shape/0",
                                      "shape/x",
                                      "poses/0.f32",
                                      "names.json",
                                      "groups.u32",
                                      "geometry.u32",
                                      "shapes.json",
                                      "levels/0.u32",
                                      "a/b/c/d",
                                      "///"}) {
        EXPECT_EQ(body_of(source, address), "none") << address;
    }
}

TEST(FrameSource, FramesInAnyOrder) {
    constexpr std::uint64_t frames = 12;
    FakeFinder finder(3, frames, 60);
    FrameSource source(contents_of(60, true), finder);
    source.load({});
    Random random(3);
    for (int i = 0; i < 100; ++i) {
        const std::uint64_t f = i < 12 ? 11 - std::uint64_t(i) : random() % frames;
        const std::string number = std::to_string(f);
        EXPECT_EQ(pairs_of(source, "pairs/" + number + ".u32"), finder.pairs(f));
        EXPECT_EQ(pairs_of(source, "began/" + number + ".u32"), finder.began(f)) << f;
        EXPECT_EQ(pairs_of(source, "ended/" + number + ".u32"), finder.ended(f)) << f;
        const Json frame = json_of(source, "frame/" + number + ".json");
        EXPECT_EQ(frame["frame"], f);
        EXPECT_EQ(frame["pairs"], finder.pairs(f).size());
        EXPECT_EQ(frame["pairs_listed"], finder.pairs(f).size());
        EXPECT_EQ(frame["began"], finder.began(f).size());
        EXPECT_EQ(frame["ended"], finder.ended(f).size());
    }
}

TEST(FrameSource, KeepsTheLastFrames) {
    FakeFinder finder(4, 5, 20);
    FrameSource source(contents_of(20, true), finder);
    source.load({});
    (void)body_of(source, "frame/0.f32");
    (void)body_of(source, "pairs/0.u32");
    EXPECT_EQ(finder.finds, 1);
    (void)body_of(source, "frame/1.f32");
    (void)body_of(source, "octants/1.json");
    EXPECT_EQ(finder.finds, 2);
    (void)body_of(source, "frame/4.json");  // and the frame before, for the events
    EXPECT_EQ(finder.finds, 4);
}

TEST(FrameSource, Timeline) {
    FakeFinder finder(5, 30, 40);
    FrameSource source(contents_of(40, true), finder);
    source.load({});
    EXPECT_EQ(json_of(source, "timeline.json")["done"], 0);
    std::vector<std::uint64_t> told;
    source.count_frames([&](std::uint64_t done) { told.push_back(done); }, {});
    EXPECT_EQ(told.back(), 30u);
    const Json timeline = json_of(source, "timeline.json");
    EXPECT_EQ(timeline["frames"], 30);
    EXPECT_EQ(timeline["done"], 30);
    for (std::uint64_t f = 0; f < 30; ++f) {
        EXPECT_EQ(timeline["pairs"][f], finder.pairs(f).size());
        EXPECT_EQ(timeline["began"][f], finder.began(f).size());
        EXPECT_EQ(timeline["ended"][f], finder.ended(f).size());
    }
}

TEST(FrameSource, CountingEndsAtAStopRequest) {
    FakeFinder finder(6, 1000, 5);
    finder.pause = 1ms;
    FrameSource source(contents_of(5, true), finder);
    source.load({});
    std::stop_source stop;
    std::thread counting([&] { source.count_frames({}, stop.get_token()); });
    std::this_thread::sleep_for(20ms);
    stop.request_stop();
    counting.join();
    EXPECT_LT(json_of(source, "timeline.json")["done"], 1000);
}

TEST(FrameSource, AnswersWhileFramesAreCounted) {
    constexpr std::uint64_t frames = 400;
    FakeFinder finder(7, frames, 20);
    finder.pause = 2ms;
    FrameSource source(contents_of(20, true), finder);
    source.load({});
    std::jthread counting([&](const std::stop_token& stop) { source.count_frames({}, stop); });
    std::this_thread::sleep_for(20ms);
    // A page that opens a frame waits for few frames only, not until all are counted.
    for (const std::uint64_t f : {350u, 200u, 90u}) {
        EXPECT_EQ(pairs_of(source, "pairs/" + std::to_string(f) + ".u32"), finder.pairs(f));
        EXPECT_LT(json_of(source, "timeline.json")["done"], frames / 2) << f;
        (void)json_of(source, "view.json");
        (void)json_of(source, "search.json?q=1");
    }
}

TEST(FrameSource, AFrameThatCannotBeRead) {
    FakeFinder finder(8, 5, 20);
    finder.broken_frame = 2;
    FrameSource source(contents_of(20, true), finder);
    source.load({});
    EXPECT_THROW(body_of(source, "frame/2.json"), Error);
    EXPECT_THROW(body_of(source, "frame/3.json"), Error);
    EXPECT_NE(body_of(source, "frame/1.json"), "none");
    EXPECT_NE(body_of(source, "frame/4.json"), "none");
    EXPECT_THROW(source.count_frames({}, {}), Error);
    EXPECT_EQ(json_of(source, "timeline.json")["done"], 2);
    EXPECT_EQ(json_of(source, "timeline.json")["failed"], "frame is broken");
    EXPECT_EQ(source.counted(), 2u);
}

TEST(FrameSource, AFrameThatDoesNotFitIntoMemory) {
    FakeFinder finder(8, 5, 20);
    finder.broken_frame = 2;
    finder.lacks_memory = true;
    FrameSource source(contents_of(20, true), finder);
    source.load({});
    EXPECT_EQ(json_of(source, "timeline.json").count("failed"), 0u);
    EXPECT_THROW(source.count_frames({}, {}), Error);
    EXPECT_EQ(json_of(source, "timeline.json")["failed"], "out of memory");
}

TEST(FrameSource, CountsTheObjectsThatExist) {
    FakeFinder finder(9, 2, 20);
    finder.exists.assign(20, 1);
    finder.exists[3] = finder.exists[7] = 0;
    FrameSource source(contents_of(20, true), finder);
    source.load({});
    EXPECT_EQ(json_of(source, "frame/1.json")["objects"], 18);
    EXPECT_EQ(json_of(source, "view.json")["objects"], 20);
}

TEST(FrameSource, OfALargeScene) {
    FakeFinder finder(9, 1, 300);
    FrameSource source(contents_of(300, false), finder, 40);
    source.load({});
    const Json view = json_of(source, "view.json");
    EXPECT_EQ(view["shown"], 40);
    EXPECT_EQ(view["has"]["near"], true);
    ASSERT_EQ(view["notices"].size(), 1u);
    EXPECT_TRUE(has_text(view["notices"][0].get<std::string>(), "260 of 300"));
    const auto shown = array_of<std::uint32_t>(body_of(source, "shown.u32"));
    EXPECT_EQ(shown.size(), 40u);
    EXPECT_EQ(body_of(source, "frame/0.f32").size(), 40u * 24);
    EXPECT_EQ(body_of(source, "levels/0.u8").size(), 40u);
    EXPECT_EQ(body_of(source, "partners/0.u32").size(), 160u);
    const auto near = array_of<std::uint32_t>(body_of(source, "near/0.bin?min=-1e9,-1e9,-1e9&max=1e9,1e9,1e9"));
    EXPECT_EQ(near[0], 260u);
    std::set<std::uint32_t> all(shown.begin(), shown.end());
    all.insert(near.begin() + 2, near.begin() + 262);
    EXPECT_EQ(all.size(), 300u);
    EXPECT_THROW(body_of(source, "near/0.bin"), Error);
}

/// Details are numbers of words. They are found by searches for objects and for rows.
TEST(FrameSource, DetailsOfObjects) {
    FakeFinder finder(8, 1, 60);
    SceneContents contents = contents_of(60, false);
    contents.details.words = {"", "IfcWall", "Level 1", "steel"};
    contents.details.columns = {{"type", std::vector<std::uint32_t>(60)}, {"level", std::vector<std::uint32_t>(60, 2)}};
    contents.details.columns[0].words[7] = 1;
    contents.files = {{"a.ifc", 0}, {"b.ifc", 40}};
    contents.second_set = 40;
    FrameSource source(std::move(contents), finder, 50);
    source.load({});
    const Json view = json_of(source, "view.json"), details = json_of(source, "details.json");
    EXPECT_EQ(view["has"]["details"], true);
    EXPECT_EQ(view["files"][1], (Json{{"name", "b.ifc"}, {"first", 40}}));
    EXPECT_EQ(view["second_set"], 40);
    EXPECT_EQ(details["words"][1], "IfcWall");
    const auto shown = array_of<std::uint32_t>(body_of(source, "shown.u32"));
    for (std::size_t row = 0; row < shown.size(); ++row) {
        EXPECT_EQ(details["type"][row], shown[row] == 7 ? 1 : 0);
        EXPECT_EQ(details["level"][row], 2);
    }
    EXPECT_FALSE(details.contains("material"));
    EXPECT_EQ(json_of(source, "object/0/7.json")["details"], (Json{{"type", "IfcWall"}, {"level", "Level 1"}}));
    EXPECT_EQ(json_of(source, "object/0/8.json")["details"], (Json{{"level", "Level 1"}}));
    EXPECT_EQ(json_of(source, "search.json?q=ifcwall")["found"][0]["index"], 7);
    EXPECT_EQ(json_of(source, "search.json?q=ifcwall")["total"], 1);
    const Json own = json_of(source, "collisions/0.json?object=7");
    EXPECT_EQ(json_of(source, "collisions/0.json?q=WALL")["total"], own["total"]);
}

TEST(FrameSource, OfNoObjects) {
    FakeFinder finder(10, 1, 0);
    FrameSource source(contents_of(0, false), finder);
    source.load({});
    EXPECT_EQ(json_of(source, "view.json")["shown"], 0);
    EXPECT_EQ(body_of(source, "frame/0.f32"), "");
    EXPECT_EQ(json_of(source, "collisions/0.json")["total"], 0);
    EXPECT_EQ(json_of(source, "search.json?q=0")["total"], 0);
    EXPECT_EQ(body_of(source, "object/0/0.json"), "none");
    EXPECT_NE(body_of(source, "octants/0.json"), "none");
}

}  // namespace

}  // namespace octopair::test
