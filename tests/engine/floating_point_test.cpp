// Tests that calls find the same pairs for any floating-point state of the caller, and leave that state unchanged.
#include <gtest/gtest.h>

#include <cfloat>
#include <string>
#include <vector>

#include "octopair/octopair.hpp"
#include "support/compare.hpp"
#include "support/floating_point.hpp"
#include "support/kinds.hpp"

namespace octopair::test {
namespace {

/// Objects whose pairs depend on rounding, or on subnormal numbers.
struct Asked {
    std::string name;
    std::vector<Box3f> narrow;
    std::vector<Box3d> wide;  ///< empty: the boxes are float32
    std::vector<double> padding;
    double margin;

    Objects objects() const {
        if (wide.empty()) return {narrow, padding};
        return {wide, padding};
    }
};

/// Boxes on a grid, a few steps wide. Before rounding, many gaps are exactly as wide as the margin.
template <typename Real>
std::vector<Box<Real>> grid_boxes(Real step) {
    std::vector<Box<Real>> boxes;
    std::uint32_t random = 1;
    for (int i = 0; i < 400; ++i) {
        Box<Real> box;
        for (int axis = 0; axis < 3; ++axis) {
            random = random * 1664525 + 1013904223;
            box.min[axis] = Real(int(random >> 16) % 12) * step;
            box.max[axis] = box.min[axis] + Real(int(random >> 28) % 3) * step;
        }
        boxes.push_back(box);
    }
    return boxes;
}

std::vector<Asked> all_asked() {
    std::vector<double> paddings(400), tiny(400);
    for (std::size_t i = 0; i < paddings.size(); ++i) {
        paddings[i] = 0.05 * double(i % 3);
        tiny[i] = DBL_TRUE_MIN * double(i % 3);
    }
    return {{"float32", make_boxes("uniform", 400, 1), {}, {}, 0},
            {"float32 subnormal", grid_boxes<float>(FLT_TRUE_MIN), {}, {}, 0},
            {"float32 with margin", grid_boxes<float>(0.1f), {}, {}, 0.1},
            {"float32 subnormal with margin", grid_boxes<float>(FLT_TRUE_MIN), {}, {}, double(FLT_TRUE_MIN)},
            {"float64", {}, make_double_boxes("far-origin", 400, 1), {}, 0},
            {"float64 with paddings", {}, grid_boxes<double>(0.1), paddings, 0.1},
            {"float64 subnormal", {}, grid_boxes<double>(DBL_TRUE_MIN), {}, 0},
            {"float64 subnormal with paddings", {}, grid_boxes<double>(DBL_TRUE_MIN), tiny, DBL_TRUE_MIN}};
}

class EngineFloatingPoint : public ::testing::TestWithParam<CallerState> {};

/// The results of all calls of an engine on one case.
struct Found {
    std::vector<Pair> ascending, octal, between, streamed, job;
    std::uint64_t counted = 0;
};

Found find_all(const Asked& asked, unsigned threads) {
    Found found;
    const auto engine = make_local_engine(threads);
    const Objects objects = asked.objects();
    Options options{.margin = asked.margin};
    PairList list, octal, between;
    engine->find_pairs(objects, list, options);
    engine->find_pairs(Join{objects, objects}, between, options);
    engine->stream_pairs(
        objects, [&](auto batch) { found.streamed.insert(found.streamed.end(), batch.begin(), batch.end()); }, options);
    found.counted = engine->count_pairs(objects, options);
    Job job = engine->submit(borrowed(objects), options);
    found.job = job.take_pairs().to_vector();
    options.order = Order::octal;
    engine->find_pairs(objects, octal, options);
    found.ascending = list.to_vector();
    found.octal = octal.to_vector();
    found.between = between.to_vector();
    return found;
}

TEST_P(EngineFloatingPoint, ChangesNoPairs) {
    for (const Asked& asked : all_asked()) {
        const Found expected = find_all(asked, 1);
        EXPECT_FALSE(expected.ascending.empty());
        for (const unsigned threads : {1u, 2u, 3u}) {
            Found found;
            call_in(GetParam(), [&] { found = find_all(asked, threads); });
            SCOPED_TRACE(std::string(asked.name) + ", " + std::to_string(threads) + " threads");
            EXPECT_TRUE(same_sequence(found.ascending, expected.ascending));
            EXPECT_TRUE(same_sequence(found.octal, expected.octal));
            EXPECT_TRUE(same_sequence(found.between, expected.between));
            EXPECT_TRUE(same_sequence(found.streamed, expected.streamed));
            EXPECT_TRUE(same_sequence(found.job, expected.job));
            EXPECT_EQ(found.counted, expected.counted);
        }
    }
}

TEST_P(EngineFloatingPoint, IsRestoredAfterAnError) {
    const std::vector<Box3d> boxes = {{{0, 0, 0}, {1, 1, 1}}, {{2 * DBL_TRUE_MIN, 0, 0}, {DBL_TRUE_MIN, 1, 1}}};
    for (const unsigned threads : {1u, 2u}) {
        const auto engine = make_local_engine(threads);
        PairList pairs;
        const auto find = [&] { call_in(GetParam(), [&] { engine->find_pairs({boxes}, pairs); }); };
        EXPECT_THROW(find(), Error) << "min > max, by a subnormal number";
        Options options{.margin = -DBL_TRUE_MIN};
        const auto submit = [&] {
            call_in(GetParam(), [&] { (void)engine->submit(OwnedObjects{boxes, {}}, options); });
        };
        EXPECT_THROW(submit(), Error) << "a negative margin";
    }
}

TEST_P(EngineFloatingPoint, IsTheDefaultInCallbacks) {
    const std::vector<Box3d> boxes = make_double_boxes("uniform", 1000, 1);
    const auto engine = make_local_engine(2);
    const unsigned expected = floating_point_control() & ~0x3Fu;
    unsigned in_sink = 0, in_progress = 0;
    Options options;
    options.progress = [&](double) { in_progress = floating_point_control() & ~0x3Fu; };
    const PairSink sink = [&](auto) { in_sink = floating_point_control() & ~0x3Fu; };
    call_in(GetParam(), [&] { engine->stream_pairs({boxes}, sink, options); });
    EXPECT_EQ(in_sink, expected);
    EXPECT_EQ(in_progress, expected);
}

INSTANTIATE_TEST_SUITE_P(States, EngineFloatingPoint, ::testing::ValuesIn(caller_states()),
                         [](const auto& param) { return std::string(param.param.name); });

}  // namespace
}  // namespace octopair::test
