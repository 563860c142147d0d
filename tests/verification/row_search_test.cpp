// Tests RowSearch, the second algorithm, against brute force, on random calls of every kind and on boxes at the limits
// of the number range.
#include "verification/row_search.hpp"

#include <gtest/gtest.h>

#include <limits>

#include "baselines/baselines.hpp"
#include "support/cases.hpp"
#include "support/compare.hpp"
#include "support/errors.hpp"
#include "support/kinds.hpp"
#include "support/scale.hpp"

namespace octopair::test {
namespace {

std::vector<Pair> found_by(const RowSearch& search) {
    std::vector<Pair> pairs;
    std::vector<std::uint32_t> columns;
    for (std::uint32_t a = 0; a < search.rows(); ++a) {
        search.row(a, columns);
        for (const std::uint32_t b : columns) pairs.push_back({a, b});
    }
    return pairs;
}

/// Expects that is_pair() returns true for exactly the given pairs.
void expect_judged(const RowSearch& search, const std::vector<Pair>& pairs) {
    std::vector<Pair> judged;
    for (std::uint32_t a = 0; a < search.rows(); ++a) {
        for (std::uint32_t b = search.is_join() ? 0 : a + 1; b < search.columns(); ++b) {
            if (search.is_pair(a, b)) judged.push_back({a, b});
        }
    }
    EXPECT_TRUE(same_bytes(judged, pairs));
}

void expect_right(const SearchedObjects& objects, unsigned threads) {
    Team team(threads);
    const RowSearch search(objects, team);
    const std::vector<Pair> expected =
        objects.second != nullptr ? baselines::oracle_pairs_between(objects.first, *objects.second, objects.margin)
                                  : baselines::oracle_pairs(objects.first, objects.margin);
    const std::vector<Pair> found = found_by(search);
    EXPECT_TRUE(same_pairs(found, expected, {objects.first, objects.second}));
    EXPECT_TRUE(same_bytes(found, expected));
    if (objects.first.size() <= 200) expect_judged(search, expected);
}

class RowSearchOfKind : public ::testing::TestWithParam<std::string> {};

TEST_P(RowSearchOfKind, FindsWhatBruteForceFinds) {
    for (std::uint64_t i = 0; i < case_count(scaled(60, 5)); ++i) {
        const Case asked = make_case(GetParam(), case_seed(GetParam(), i));
        const Objects first = asked.first.view();
        const Objects second = asked.second ? asked.second->view() : Objects{};
        expect_right({first, asked.second ? &second : nullptr, asked.margin}, asked.threads[i % 3]);
        ASSERT_FALSE(HasFailure()) << asked.describe();
    }
}

INSTANTIATE_TEST_SUITE_P(Kinds, RowSearchOfKind, ::testing::ValuesIn(all_kind_names()), param_name);

/// Returns a box for each two numbers low <= high: [low, high] on x and y, and [-high, -low] on z.
template <typename Real>
std::vector<Box<Real>> boxes_among(const std::vector<Real>& numbers) {
    std::vector<Box<Real>> boxes;
    for (const Real low : numbers) {
        for (const Real high : numbers) {
            if (low <= high) boxes.push_back({{low, low, -high}, {high, high, -low}});
        }
    }
    return boxes;
}

template <typename Real>
class RowSearchAtTheEnds : public ::testing::Test {};
using Reals = ::testing::Types<float, double>;
TYPED_TEST_SUITE(RowSearchAtTheEnds, Reals);

TYPED_TEST(RowSearchAtTheEnds, DenormalAndLargestNumbers) {
    using Limits = std::numeric_limits<TypeParam>;
    const TypeParam least = Limits::denorm_min(), most = Limits::max();
    const auto boxes = boxes_among<TypeParam>(
        {-most, -1, -2 * least, -least, TypeParam(-0.0), 0, least, 2 * least, 3 * least, Limits::min(), 1, most});
    const Objects objects{boxes, {}};
    const double largest = std::numeric_limits<double>::max();
    for (const double margin : {0.0, double(least), 2.5 * double(least), 1.0, double(most), largest}) {
        expect_right({objects, nullptr, margin}, 2);
        expect_right({objects, &objects, margin}, 1);
    }
    std::vector<double> padding(boxes.size());
    for (std::size_t i = 0; i < padding.size(); ++i) padding[i] = i % 3 == 0 ? double(least) : i % 7 == 0 ? largest : 0;
    expect_right({{objects.boxes, padding}, nullptr, 0}, 1);
    expect_right({{objects.boxes, padding}, nullptr, largest}, 3);
}

TEST(RowSearch, NoObjects) {
    expect_right({{}, nullptr, 0}, 2);
    const std::vector<Box3f> one = {{{0, 0, 0}, {1, 1, 1}}};
    const Objects none, some{one, {}};
    expect_right({some, nullptr, 0}, 2);
    expect_right({none, &some, 0}, 2);
    expect_right({some, &none, 0}, 2);
}

TEST(RowSearch, AnyNumberOfObjects) {
    const std::vector<Box3f> boxes = make_boxes("uniform", 600, 1);
    for (std::size_t n = 1; n <= boxes.size(); n += 1 + n / 40) {
        expect_right({{std::span(boxes).first(n), {}}, nullptr, 0.01}, unsigned(1 + n % 4));
        ASSERT_FALSE(HasFailure()) << n;
    }
}

TEST(RowSearch, StopsWhenAsked) {
    const std::vector<Box3f> boxes = make_boxes("uniform", 5000, 1);
    Team team(1);
    (void)error_of(ErrorCode::cancelled, [&] {
        const RowSearch search({{boxes, {}}, nullptr, 0}, team, requested_stop());
    });
}

}  // namespace
}  // namespace octopair::test
