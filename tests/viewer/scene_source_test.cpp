// SceneSource and write_page on a scene in memory.
#include <gtest/gtest.h>
#include <zlib.h>

#include <atomic>
#include <map>
#include <set>
#include <thread>

#include "octopair/error.hpp"
#include "viewer/scene/page_file.hpp"
#include "viewer/scene/scene_source.hpp"
#include "viewer/server/page.hpp"
#include "viewer/shown_frames.hpp"

namespace octopair::test {

namespace {

using viewer::Address;
using viewer::SceneContents;
using viewer::SceneSource;
using namespace std::chrono_literals;

/// Finds the pairs of frames in memory by brute force. Fails if two threads use it at once.
class FakeFinder final : public viewer::FrameFinder {
public:
    FakeFinder(std::uint64_t seed, std::uint64_t frames, std::size_t objects) {
        Random random(seed);
        std::vector<Box3d> boxes = random_boxes(random, objects);
        for (std::uint64_t f = 0; f < frames; ++f) {
            boxes_.push_back(boxes);
            pairs_.push_back(true_pairs(boxes));
            for (std::size_t i = 0; i < objects; i += 1 + random() % 5) boxes[i] = random_boxes(random, 1, 0.02)[0];
        }
    }

    std::uint64_t frames() const override { return boxes_.size(); }

    viewer::FrameData find(std::uint64_t frame, const ProgressSink& progress) override {
        EXPECT_FALSE(busy_.exchange(true)) << "two threads at once";
        if (progress) progress(0.5);
        std::this_thread::sleep_for(pause);
        if (frame == broken_frame) {
            busy_ = false;
            throw Error(ErrorCode::bad_input, "frame is broken");
        }
        viewer::FrameData data;
        data.boxes = std::span<const Box3d>(boxes_[frame]);
        data.pairs = pairs_[frame];
        data.pair_count = data.pairs.size();
        data.facts.push_back({"seconds.detect", 0.5});
        ++finds;
        busy_ = false;
        return data;
    }

    std::vector<Pair> pairs(std::uint64_t frame) const { return pairs_[frame]; }
    std::vector<Pair> began(std::uint64_t frame) const { return missing_in(frame, frame - 1); }
    std::vector<Pair> ended(std::uint64_t frame) const {
        return frame == 0 ? std::vector<Pair>() : missing_in(frame - 1, frame);
    }

    std::chrono::milliseconds pause{0};
    std::uint64_t broken_frame = ~std::uint64_t(0);
    std::atomic<int> finds = 0;

private:
    /// Returns the pairs of a frame that another frame does not have.
    std::vector<Pair> missing_in(std::uint64_t frame, std::uint64_t other) const {
        std::vector<Pair> pairs, none;
        const std::vector<Pair>& known = other < pairs_.size() ? pairs_[other] : none;
        std::set_difference(pairs_[frame].begin(), pairs_[frame].end(), known.begin(), known.end(),
                            std::back_inserter(pairs));
        return pairs;
    }

    std::vector<std::vector<Box3d>> boxes_;
    std::vector<std::vector<Pair>> pairs_;
    std::atomic<bool> busy_ = false;
};

SceneContents contents_of(std::uint64_t objects, bool moving) {
    SceneContents contents;
    contents.title = "scene";
    contents.objects = objects;
    contents.moving = moving;
    return contents;
}

std::string body_of(SceneSource& source, const std::string& address) {
    const auto answer = source.get(*Address::parse('/' + address));
    return answer ? answer->body : "none";
}
Json json_of(SceneSource& source, const std::string& address) { return Json::parse(body_of(source, address)); }
std::vector<Pair> pairs_of(SceneSource& source, const std::string& address) {
    return array_of<Pair>(body_of(source, address));
}

TEST(SceneSource, LoadsTheFirstFrame) {
    FakeFinder finder(1, 1, 50);
    SceneSource source(contents_of(50, false), finder);
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

TEST(SceneSource, UnknownAddressesHaveNoData) {
    FakeFinder finder(2, 3, 20);
    SceneSource source(contents_of(20, true), finder);
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

TEST(SceneSource, FramesInAnyOrder) {
    constexpr std::uint64_t frames = 12;
    FakeFinder finder(3, frames, 60);
    SceneSource source(contents_of(60, true), finder);
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

TEST(SceneSource, KeepsTheLastFrames) {
    FakeFinder finder(4, 5, 20);
    SceneSource source(contents_of(20, true), finder);
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

TEST(SceneSource, Timeline) {
    FakeFinder finder(5, 30, 40);
    SceneSource source(contents_of(40, true), finder);
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

TEST(SceneSource, CountingEndsAtAStopRequest) {
    FakeFinder finder(6, 1000, 5);
    finder.pause = 1ms;
    SceneSource source(contents_of(5, true), finder);
    source.load({});
    std::stop_source stop;
    std::thread counting([&] { source.count_frames({}, stop.get_token()); });
    std::this_thread::sleep_for(20ms);
    stop.request_stop();
    counting.join();
    EXPECT_LT(json_of(source, "timeline.json")["done"], 1000);
}

TEST(SceneSource, AnswersWhileFramesAreCounted) {
    constexpr std::uint64_t frames = 400;
    FakeFinder finder(7, frames, 20);
    finder.pause = 2ms;
    SceneSource source(contents_of(20, true), finder);
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

TEST(SceneSource, AFrameThatCannotBeRead) {
    FakeFinder finder(8, 5, 20);
    finder.broken_frame = 2;
    SceneSource source(contents_of(20, true), finder);
    source.load({});
    EXPECT_THROW(body_of(source, "frame/2.json"), Error);
    EXPECT_THROW(body_of(source, "frame/3.json"), Error);
    EXPECT_NE(body_of(source, "frame/1.json"), "none");
    EXPECT_NE(body_of(source, "frame/4.json"), "none");
    EXPECT_THROW(source.count_frames({}, {}), Error);
    EXPECT_EQ(json_of(source, "timeline.json")["done"], 2);
}

TEST(SceneSource, OfALargeScene) {
    FakeFinder finder(9, 1, 300);
    SceneSource source(contents_of(300, false), finder, 40);
    source.load({});
    const Json view = json_of(source, "view.json");
    EXPECT_EQ(view["shown"], 40);
    EXPECT_EQ(view["has"]["near"], true);
    ASSERT_EQ(view["notices"].size(), 1u);
    EXPECT_NE(view["notices"][0].get<std::string>().find("260 of 300"), std::string::npos);
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

TEST(SceneSource, OfNoObjects) {
    FakeFinder finder(10, 1, 0);
    SceneSource source(contents_of(0, false), finder);
    source.load({});
    EXPECT_EQ(json_of(source, "view.json")["shown"], 0);
    EXPECT_EQ(body_of(source, "frame/0.f32"), "");
    EXPECT_EQ(json_of(source, "collisions/0.json")["total"], 0);
    EXPECT_EQ(json_of(source, "search.json?q=0")["total"], 0);
    EXPECT_EQ(body_of(source, "object/0/0.json"), "none");
    EXPECT_NE(body_of(source, "octants/0.json"), "none");
}

// ---- Exported pages ------------------------------------------------------------------------------------------------

int base64_value(char c) {
    constexpr std::string_view digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    const std::size_t at = digits.find(c);
    return at == std::string_view::npos ? -1 : int(at);
}

std::string from_base64(std::string_view text) {
    EXPECT_EQ(text.size() % 4, 0u);
    std::string bytes;
    std::uint32_t word = 0, bits = 0;
    for (const char c : text) {
        if (c == '=') break;
        EXPECT_GE(base64_value(c), 0);
        word = word << 6 | std::uint32_t(base64_value(c));
        bits += 6;
        if (bits < 8) continue;
        bits -= 8;
        bytes += char(word >> bits & 255);
    }
    return bytes;
}

/// Unpacks gzip of any length, without code of the viewer.
std::string unpacked(const std::string& compressed) {
    z_stream stream{};
    EXPECT_EQ(inflateInit2(&stream, 15 + 16), Z_OK);
    stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(compressed.data()));
    stream.avail_in = uInt(compressed.size());
    std::string out;
    int result = Z_OK;
    while (result == Z_OK) {
        std::array<char, 65536> part;
        stream.next_out = reinterpret_cast<Bytef*>(part.data());
        stream.avail_out = uInt(part.size());
        result = inflate(&stream, Z_NO_FLUSH);
        out.append(part.data(), part.size() - stream.avail_out);
    }
    EXPECT_EQ(result, Z_STREAM_END);
    inflateEnd(&stream);
    return out;
}

/// Reads the elements of a page as a browser does.
std::map<std::string, std::string> data_of(const std::string& page) {
    std::map<std::string, std::string> data;
    constexpr std::string_view before = "<script type=\"application/octet-stream\" data-address=\"", end = "</script>";
    for (std::size_t at = 0; (at = page.find(before, at)) != std::string::npos;) {
        const std::size_t name = at + before.size(), quote = page.find("\">", name), last = page.find(end, quote);
        const std::string address = page.substr(name, quote - name);
        EXPECT_FALSE(data.contains(address)) << address;
        data[address] = unpacked(from_base64(std::string_view(page).substr(quote + 2, last - quote - 2)));
        at = last;
    }
    return data;
}

std::string page_of(SceneSource& source, std::uint64_t most = viewer::max_page_bytes) {
    std::string page;
    write_page(
        source, [&](std::string_view text) { page += text; }, most);
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
        SceneSource source(contents_of(70, moving), finder, 50), exported(contents_of(70, moving), finder, 50);
        source.load({});
        exported.load({});
        if (moving) {
            source.count_frames({}, {});
            exported.count_frames({}, {});
        }
        const auto data = data_of(page_of(exported));
        for (const auto& [address, bytes] : data) {
            if (address == "view.json") continue;
            const bool table = address.starts_with("collisions/");
            EXPECT_EQ(bytes, body_of(source, address + (table ? "?count=1000" : ""))) << address;
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

TEST(PageFile, LeavesOutFramesBeyondTheLimit) {
    FakeFinder finder(21, 20, 60);
    SceneSource whole(contents_of(60, true), finder), part(contents_of(60, true), finder);
    for (SceneSource* source : {&whole, &part}) {
        source->load({});
        source->count_frames({}, {});
    }
    const std::uint64_t html = octopair::viewer::page().size(), most = html + (page_of(whole).size() - html) / 2;
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
    SceneSource source(contents_of(60, true), finder);
    source.load({});
    bool wrote = false;
    EXPECT_THROW(write_page(
                     source, [&](std::string_view) { wrote = true; }, 1000),
                 Error);
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
        SceneSource source(std::move(contents), finder);
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
    SceneSource source(contents, finder);
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
