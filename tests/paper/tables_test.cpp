// Tests the arithmetic of the tables against the printed values of the paper.
#include "paper/tables.hpp"

#include <gtest/gtest.h>

#include "paper/published.hpp"

namespace octopair::paper {
namespace {

/// Values printed in tables 1 and 2.
struct Printed {
    double speedup;
    double percent;
};

constexpr std::array<std::array<Printed, 5>, 2> printed = {{
    {{{1.89, 94.7}, {8.17, 81.7}, {13.56, 67.8}, {17.56, 58.5}, {19.95, 49.9}}},
    {{{1.91, 95.3}, {8.27, 82.7}, {13.89, 69.5}, {17.92, 59.7}, {20.66, 51.7}}},
}};

TEST(Tables, SpeedupsAreThoseThatThePaperPrints) {
    for (std::size_t table = 0; table < printed.size(); ++table) {
        const auto& times = published_tables[table].times;
        for (std::size_t i = 0; i < printed[table].size(); ++i) {
            const PublishedTime& time = times[i + 1];
            const Speedup speedup =
                speedup_of({double(time.microseconds), time.processors}, double(times[0].microseconds));
            EXPECT_NEAR(speedup.speedup, printed[table][i].speedup, 0.0051) << table << ", " << i;
            EXPECT_NEAR(speedup.efficiency * 100, printed[table][i].percent, 0.051) << table << ", " << i;
        }
    }
}

TEST(Tables, PublishedTimesByObjects) {
    EXPECT_EQ(published_times(1'000'000).size(), 6u);
    EXPECT_EQ(published_times(2'000'000).front().microseconds, 59'706'876u);
    EXPECT_TRUE(published_times(1'500'000).empty());
}

/// Makes a study in which octopair takes 1 microsecond per object on one processor, and every other program takes 10.
Study made_study(const std::vector<std::uint64_t>& objects, unsigned threads) {
    Study study{{"uniform", objects, threads, 1, 20}, {}};
    for (const Setup& setup : setups(threads)) {
        Series& series = study.series.emplace_back(Series{setup, {}});
        const double slower = setup.finder == Finder::octopair ? 1 : 10;
        for (const std::uint64_t n : objects) {
            const double seconds = slower * double(n) * 1e-6 / setup.processors();
            series.points.push_back({n, 5, 0, {{seconds, {seconds / 2, seconds / 4, 0, 0, seconds / 4}}}});
        }
    }
    return study;
}

TEST(Tables, ThePapersNumbersOfObjectsHaveATable) {
    using Objects = std::vector<std::uint64_t>;
    EXPECT_EQ(table_objects(made_study({1000, 1'000'000, 1'500'000, 2'000'000}, 1)), (Objects{1'000'000, 2'000'000}));
    EXPECT_EQ(table_objects(made_study({1000, 2000}, 1)), Objects{2000});
}

TEST(Tables, TextHoldsOursAndThePapers) {
    const std::string text = study_text(made_study({500'000, 1'000'000}, 4));
    for (const char* part :
         {"Figure 5: run time in milliseconds, uniform", "Table 1: run time in microseconds, 1,000,000 objects",
          "29,537,415", "1,480,608     19.95       49.9%", "5,000,000      2.00      100.0%", "2 x 2",
          "Components in microseconds, 1,000,000 objects on 4 processor(s); as published: on 40", "1,307,631",
          "octopair on 3"}) {
        EXPECT_NE(text.find(part), std::string::npos) << part << "\n" << text;
    }
    EXPECT_EQ(text.find("Table 2"), std::string::npos);
}

}  // namespace
}  // namespace octopair::paper
