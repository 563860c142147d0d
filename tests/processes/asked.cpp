#include "processes/asked.hpp"

#include <gtest/gtest.h>

#include "samples/random.hpp"
#include "samples/scenes.hpp"
#include "support/compare.hpp"
#include "support/kinds.hpp"

namespace octopair::test {

namespace {

Options options_of(const Asked& asked) {
    Options options{.order = asked.order, .margin = asked.margin, .limit = asked.limit};
    if (asked.windows) options.buffer_bytes = 0;
    return options;
}

/// Makes clusters within a part of the world that is smaller than the smallest octant.
std::vector<Box3f> tiny_clusters(std::uint64_t objects, std::uint64_t seed) {
    constexpr float part = 0x1p-27F;
    std::vector<Box3f> boxes = make_boxes("clustered", objects, seed);
    for (Box3f& box : boxes) {
        for (std::size_t axis = 0; axis < 3; ++axis) {
            box.min[axis] *= part;
            box.max[axis] *= part;
        }
    }
    return boxes;
}

std::vector<Box3f> boxes_of(const std::string& kind, std::uint64_t objects, std::uint64_t seed) {
    if (kind == "speck") {
        std::vector<Box3f> boxes = make_boxes("uniform", objects / 8, seed);
        const std::vector<Box3f> speck = tiny_clusters(objects - objects / 8, seed);
        boxes.insert(boxes.end(), speck.begin(), speck.end());
        return boxes;
    }
    if (kind != "crowd") return make_boxes(kind, objects, seed);
    std::vector<Box3f> boxes = make_boxes("uniform", objects - objects / 40, seed);
    const std::vector<Box3f> crowd = make_boxes("coincident", objects / 40, seed);
    boxes.insert(boxes.end(), crowd.begin(), crowd.end());
    return boxes;
}

}  // namespace

std::string Asked::describe() const {
    constexpr const char* names[] = {"list", "stream", "count"};
    std::string text = names[int(how)];
    text += order == Order::octal ? " octal" : " ascending";
    if (windows) text += ", in windows";
    if (join) text += ", join";
    if (padded) text += ", padded";
    if (wide) text += ", float64";
    if (margin > 0) text += ", margin " + std::to_string(margin);
    if (limit) text += ", limit " + std::to_string(*limit);
    return text;
}

Scene::Scene(const std::string& name, std::uint64_t objects, std::uint64_t seed)
    : kind(name),
      first(boxes_of(name, objects, seed)),
      second(boxes_of(name, objects / 2, seed + 1)),
      wide_first(widened(first)),
      wide_second(widened(second)) {
    samples::RandomStream random(seed, 3);
    for (std::size_t i = 0; i < first.size(); ++i) padding.push_back(random.uniform(0, 1e-3));
}

Objects Scene::objects(const Asked& asked) const {
    Objects all;
    if (asked.wide) {
        all.boxes = std::span(wide_first);
    } else {
        all.boxes = std::span(first);
    }
    if (asked.padded) all.padding = padding;
    return all;
}

Objects Scene::others(const Asked& asked) const {
    if (asked.wide) return {wide_second};
    return {second};
}

Answer ask(Engine& engine, const Scene& scene, const Asked& asked, std::stop_token stop) {
    const Options options = options_of(asked);
    const Input input(scene.objects(asked), asked.join ? std::optional(scene.others(asked)) : std::nullopt);
    Answer answer;
    if (asked.how == How::list) {
        PairList list;
        const Summary summary = engine.find_pairs(input, list, options, stop);
        answer = {list.to_vector(), summary.pairs, summary.truncated};
    } else if (asked.how == How::stream) {
        const PairSink sink = [&](std::span<const Pair> batch) {
            answer.pairs.insert(answer.pairs.end(), batch.begin(), batch.end());
        };
        const Summary summary = engine.stream_pairs(input, sink, options, stop);
        answer.count = summary.pairs;
        answer.truncated = summary.truncated;
    } else {
        answer.count = engine.count_pairs(input, options, stop);
    }
    return answer;
}

void expect_same(const Answer& found, const Answer& expected) {
    EXPECT_TRUE(same_bytes(found.pairs, expected.pairs));
    EXPECT_EQ(found.count, expected.count);
    EXPECT_EQ(found.truncated, expected.truncated);
}

void expect_right(Engine& engine, const Scene& scene, const Asked& asked) {
    SCOPED_TRACE(asked.describe());
    const Answer expected = ask(*make_local_engine(1), scene, asked);
    expect_same(ask(engine, scene, asked), expected);
}

std::vector<Asked> all_ways() {
    std::vector<Asked> ways;
    for (const Order order : {Order::octal, Order::ascending}) {
        ways.push_back({.how = How::list, .order = order});
        ways.push_back({.how = How::stream, .order = order});
        ways.push_back({.how = How::stream, .order = order, .windows = true});
    }
    ways.push_back({.how = How::count});
    return ways;
}

Asked random_call(std::uint64_t seed) {
    samples::RandomStream random(seed, 11);
    const std::vector<Asked> ways = all_ways();
    Asked asked = ways[random.below(ways.size())];
    asked.join = random.below(4) == 0;
    asked.wide = random.below(3) == 0;
    asked.padded = random.below(4) == 0;
    if (random.below(3) == 0) asked.margin = random.uniform(0, 1e-3);
    return asked;
}

}  // namespace octopair::test
