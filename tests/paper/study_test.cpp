// Tests the counts that a study measures, but not its times.
#include "paper/study.hpp"

#include <gtest/gtest.h>

#include "octopair/error.hpp"
#include "support/errors.hpp"

namespace octopair::paper {
namespace {

std::vector<std::string> setup_texts(unsigned threads) {
    std::vector<std::string> texts;
    for (const Setup& setup : setups(threads)) {
        texts.push_back(std::string(finder_text(setup.finder)) + " " + processors_text(setup));
    }
    return texts;
}

TEST(Study, SetupsFollowTheProcessors) {
    using Texts = std::vector<std::string>;
    EXPECT_EQ(setup_texts(1), (Texts{"paper 1", "paper, std::sort 1", "octopair 1"}));
    EXPECT_EQ(setup_texts(2), (Texts{"paper 1", "paper 2", "paper, std::sort 2", "octopair 1", "octopair 2"}));
    EXPECT_EQ(setup_texts(6),
              (Texts{"paper 1", "paper 2", "paper 3", "paper 4", "paper 2 x 2", "paper 6", "paper 3 x 2",
                     "paper, std::sort 6", "octopair 1", "octopair 2", "octopair 3", "octopair 4", "octopair 6"}));
    EXPECT_EQ(setup_texts(40).back(), "octopair 40");
    EXPECT_EQ(setups(40)[7].processors(), 16u);
}

TEST(Study, EverySetupIsMeasuredWithTheSamePairs) {
    double last = 0;
    bool falls = false;
    const auto progress = [&](std::string_view, double done) {
        falls = falls || done < last;
        last = done;
    };
    const Study study = measure({"mixed", {500, 1500}, 4, 2, 20}, progress, {});
    ASSERT_EQ(study.series.size(), setups(4).size());
    for (const Series& series : study.series) {
        const bool once = series.setup.finder == Finder::paper_standard_sort;
        ASSERT_EQ(series.points.size(), once ? 1u : 2u);
        EXPECT_EQ(series.points.back().objects, 1500u);
        EXPECT_EQ(series.points.back().pairs, study.series[0].points[1].pairs);
        EXPECT_EQ(series.points.back().runs.size(), 2u);
        EXPECT_GT(series.points.back().median_seconds(), 0);
        EXPECT_EQ(series.points.back().level == 0, series.setup.finder == Finder::octopair);
    }
    EXPECT_GT(study.series[0].points[1].pairs, 0u);
    EXPECT_EQ(study.series[0].point(499), nullptr);
    EXPECT_FALSE(falls);
    EXPECT_LE(last, 1);
}

TEST(Study, RestsAfterThreeRounds) {
    const Study study = measure({"uniform", {500}, 1, 6, 0}, {}, {});
    for (const Series& series : study.series) EXPECT_EQ(series.points[0].runs.size(), 3u);
}

TEST(Study, MediansOfEachStep) {
    const Point point{10, 0, 0, {{1, {1, 6, 0, 0, 2}}, {2, {3, 4, 0, 0, 9}}, {9, {2, 5, 0, 0, 1}}}};
    EXPECT_EQ(point.median_seconds(), 2);
    EXPECT_EQ(point.median_steps().encode, 2);
    EXPECT_EQ(point.median_steps().sort, 5);
    EXPECT_EQ(point.median_steps().scan, 2);
}

TEST(Study, StopsWhenAsked) {
    std::stop_source stop;
    int said = 0;
    const auto progress = [&](std::string_view, double) {
        if (++said == 5) stop.request_stop();
    };
    const auto call = [&] { (void)measure({"uniform", {1000}, 2, 5, 20}, progress, stop.get_token()); };
    (void)test::error_of(ErrorCode::cancelled, call);
    EXPECT_EQ(said, 5);
}

TEST(Study, UnknownSceneIsRefused) { EXPECT_THROW((void)measure({"nothing", {1000}, 1, 3, 20}, {}, {}), Error); }

}  // namespace
}  // namespace octopair::paper
