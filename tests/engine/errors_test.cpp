// Tests invalid calls: the error code, the object and value in the message, and that the engine still works afterwards.
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>

#include "octopair/octopair.hpp"
#include "samples/scenes.hpp"
#include "support/errors.hpp"

namespace octopair::test {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr double nan_value = std::numeric_limits<double>::quiet_NaN();

class EngineErrors : public ::testing::TestWithParam<unsigned> {
protected:
    EngineErrors() : engine_(make_local_engine(GetParam())) {}

    /// Expects `call` to throw bad_input with all `words` in one line, then the engine to work.
    void expect_refused(const std::function<void()>& call, const std::vector<std::string>& words) {
        const std::string message = error_of(ErrorCode::bad_input, call);
        EXPECT_EQ(message.find('\n'), std::string::npos) << message;
        for (const std::string& word : words) EXPECT_TRUE(has_text(message, word));
        EXPECT_EQ(engine_->count_pairs({good_}), 1u);
    }

    /// Expects that every call refuses `objects` and leaves the list empty.
    void expect_all_refuse(const Objects& objects, const Options& options, const std::vector<std::string>& words) {
        const Objects good{good_};
        const PairSink sink = [](std::span<const Pair>) { ADD_FAILURE() << "pairs of an invalid input"; };
        for (const Order order : {Order::ascending, Order::octal}) {
            Options used = options;
            used.order = order;
            engine_->find_pairs(good, list_);
            ASSERT_EQ(list_.size(), 1u);
            expect_refused([&] { engine_->find_pairs(objects, list_, used); }, words);
            EXPECT_EQ(list_.size(), 0u);
            EXPECT_TRUE(list_.chunks().empty());
            expect_refused([&] { engine_->find_pairs(Join{good, objects}, list_, used); }, words);
            expect_refused([&] { engine_->find_pairs(Join{objects, good}, list_, used); }, words);
            expect_refused([&] { engine_->stream_pairs(objects, sink, used); }, words);
            expect_refused([&] { engine_->count_pairs(objects, used); }, words);
        }
    }

    template <typename Real>
    void expect_bad_number(Real value, const std::vector<std::string>& words) {
        for (const std::size_t count : {1u, 100u, 30'000u}) {
            const std::size_t index = count * 2 / 3;
            std::vector<Box<Real>> boxes(count, Box<Real>{{0, 0, 0}, {1, 1, 1}});
            for (std::size_t i = 0; i < count; ++i) {
                for (int axis = 0; axis < 3; ++axis) boxes[i].min[axis] -= Real(i), boxes[i].max[axis] -= Real(i);
            }
            for (int field = 0; field < 6; ++field) {
                std::vector<Box<Real>> bad = boxes;
                (field < 3 ? bad[index].min : bad[index].max)[field % 3] = value;
                auto all_words = words;
                all_words.push_back(std::to_string(index));
                const Objects objects{bad};
                expect_refused([&] { engine_->find_pairs(objects, list_); }, all_words);
            }
        }
    }

    std::vector<Box3f> good_ = {{{0, 0, 0}, {1, 1, 1}}, {{1, 1, 1}, {2, 2, 2}}};
    std::unique_ptr<Engine> engine_;
    PairList list_;
};

INSTANTIATE_TEST_SUITE_P(Threads, EngineErrors, ::testing::Values(1u, 2u, 8u));

TEST_P(EngineErrors, Nan) {
    expect_bad_number<float>(float(nan_value), {"nan"});
    expect_bad_number<double>(nan_value, {"nan"});
    expect_bad_number<float>(-float(nan_value), {"nan"});
}

TEST_P(EngineErrors, Infinite) {
    expect_bad_number<float>(float(infinity), {"inf"});
    expect_bad_number<float>(-float(infinity), {"-inf"});
    expect_bad_number<double>(infinity, {"inf"});
    expect_bad_number<double>(-infinity, {"-inf"});
}

TEST_P(EngineErrors, InfiniteOnBothSides) {
    const float inf = float(infinity);
    for (const Box3f box : {Box3f{{-inf, 0, 0}, {inf, 1, 1}}, Box3f{{0, inf, 0}, {1, inf, 1}}}) {
        const std::vector<Box3f> boxes = {good_[0], good_[1], box};
        expect_all_refuse(Objects{boxes}, {}, {"2", "inf"});
    }
}

TEST_P(EngineErrors, Inverted) {
    for (int axis = 0; axis < 3; ++axis) {
        std::vector<Box3d> boxes(5000, Box3d{{0, 0, 0}, {1, 1, 1}});
        for (std::size_t i = 0; i < boxes.size(); ++i) {
            for (int k = 0; k < 3; ++k) boxes[i].min[k] += 2 * double(i), boxes[i].max[k] += 2 * double(i);
        }
        boxes[4321].min[axis] = 123456.5;
        expect_all_refuse(Objects{boxes}, {}, {"4321", "123456.5"});
    }
}

TEST_P(EngineErrors, InvertedByOneStep) {
    std::vector<Box3f> boxes = good_;
    boxes[1].min[1] = std::nextafter(boxes[1].max[1], 10.f);
    expect_all_refuse(Objects{boxes}, {}, {"1"});
}

TEST_P(EngineErrors, TheFirstBadObjectIsNamed) {
    auto boxes = samples::make_scene("uniform", 200'000, 1);
    for (const std::size_t i : {199'000u, 150'001u, 77'777u}) boxes[i].max[2] = float(nan_value);
    expect_refused([&] { engine_->find_pairs({boxes}, list_); }, {"77777", "nan"});
}

TEST_P(EngineErrors, PaddingOfAnotherLength) {
    for (const std::size_t length : {1u, 3u}) {
        const std::vector<double> padding(length, 0.5);
        expect_all_refuse(Objects{good_, padding}, {}, {std::to_string(length), "2"});
    }
}

TEST_P(EngineErrors, RefusesInvalidPadding) {
    for (const double value : {-0.25, nan_value, infinity, -infinity}) {
        const std::vector<double> padding = {0.5, value};
        expect_all_refuse(Objects{good_, padding}, {}, {"1", "padding"});
    }
}

TEST_P(EngineErrors, MarginThatIsNone) {
    for (const double value : {-0.25, nan_value, infinity, -infinity}) {
        Options options{.margin = value};
        expect_all_refuse(Objects{good_}, options, {"margin"});
    }
}

TEST_P(EngineErrors, NegativeZeroIsAMarginAndAPadding) {
    const std::vector<double> padding = {-0.0, 0.0};
    Options options{.margin = -0.0};
    EXPECT_EQ(engine_->count_pairs(Objects{good_, padding}, options), 1u);
}

TEST_P(EngineErrors, WhatASinkThrowsReachesTheCaller) {
    const auto boxes = samples::make_scene("dense", 50'000, 1);
    const Objects objects{boxes};
    struct Mine {};
    for (const Order order : {Order::ascending, Order::octal}) {
        Options options{.order = order, .buffer_bytes = 0};
        int calls = 0;
        const PairSink sink = [&](std::span<const Pair>) {
            ++calls;
            throw Mine();
        };
        EXPECT_THROW(engine_->stream_pairs(objects, sink, options), Mine);
        EXPECT_EQ(calls, 1);
        options.progress = [](double) { throw Mine(); };
        EXPECT_THROW(engine_->find_pairs(objects, list_, options), Mine);
        EXPECT_EQ(list_.size(), 0u);
        EXPECT_EQ(engine_->count_pairs({good_}), 1u);
    }
}

TEST(EngineErrorPlaces, AreIndexAndSet) {
    for (const unsigned threads : {1u, 3u}) expect_places_of_errors(*make_local_engine(threads));
}

}  // namespace
}  // namespace octopair::test
