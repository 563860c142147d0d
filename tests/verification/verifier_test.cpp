// Tests the verifier of results. Right results pass, in pieces of any length. Each planted error is found and named.
#include "verification/verifier.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>

#include "baselines/baselines.hpp"
#include "octopair/error.hpp"
#include "samples/random.hpp"
#include "support/errors.hpp"
#include "support/kinds.hpp"

namespace octopair::test {
namespace {

/// Objects, their pairs in ascending order, and the pairs in a random order in place of the octal order.
struct Scene {
    Scene(std::uint64_t objects, bool with_second)
        : boxes(make_boxes("dense", objects, 3)), more(make_boxes("dense", objects / 2, 4)) {
        first = {boxes, {}};
        second = {more, {}};
        join = with_second;
        pairs = join ? baselines::oracle_pairs_between(first, second) : baselines::oracle_pairs(first);
        mixed = pairs;
        samples::RandomStream random(1, 2);
        for (std::size_t i = mixed.size(); i > 1; --i) std::swap(mixed[i - 1], mixed[random.below(i)]);
    }
    SearchedObjects searched() const { return {first, join ? &second : nullptr, 0}; }
    const std::vector<Pair>& in(ResultKind kind) const { return kind == ResultKind::octal ? mixed : pairs; }

    std::vector<Box3f> boxes, more;
    Objects first, second;
    bool join = false;
    std::vector<Pair> pairs, mixed;
};

/// A result in the form that a call delivers.
struct Result {
    std::vector<Pair> pairs;
    bool truncated = false;
    std::optional<std::uint64_t> limit = {};
    bool list = false;  ///< the verifier also gets the whole list at the end
    std::size_t piece = 7;
    unsigned threads = 1;
};

/// Returns the verifier's message about a result, empty if the result is right.
std::string complaint(const Scene& scene, ResultKind kind, const Result& result) {
    Verifier verifier({.objects = scene.searched(), .kind = kind, .limit = result.limit, .threads = result.threads});
    const std::span<const Pair> all = result.pairs;
    try {
        for (std::size_t i = 0; i < all.size(); i += result.piece) {
            verifier.take(all.subspan(i, std::min(result.piece, all.size() - i)));
        }
        const std::array chunks = {all.first(all.size() / 3), all.subspan(all.size() / 3)};
        CallEnd end{all.size(), result.truncated};
        if (result.list) end.chunks = chunks;
        const Verification done = verifier.finish(end);
        EXPECT_TRUE(done.done);
        EXPECT_EQ(done.not_checked.empty(), kind == ResultKind::ascending);
        return {};
    } catch (const Error& error) {
        EXPECT_EQ(error.code(), ErrorCode::engine_failed);
        const std::string words = error.what();
        EXPECT_TRUE(words.starts_with("verification failed: ")) << words;
        return words.substr(words.find(": ") + 2);
    }
}

std::string name(const Pair& pair) { return "pair (" + std::to_string(pair.a) + ", " + std::to_string(pair.b) + ")"; }

struct Setting {
    ResultKind kind;
    bool join, list;
};

class VerifierOf : public ::testing::TestWithParam<Setting> {
protected:
    Result right() const { return {.pairs = scene_.in(GetParam().kind), .list = GetParam().list}; }
    std::string said(const Result& result) const { return complaint(scene_, GetParam().kind, result); }
    bool ascending() const { return GetParam().kind == ResultKind::ascending; }

    Scene scene_{120, GetParam().join};
};

TEST_P(VerifierOf, PassesWhatIsRight) {
    ASSERT_GT(scene_.pairs.size(), 200u);
    for (const std::size_t piece : {1u, 2u, 7u, 100u, 1u << 20}) {
        Result result = right();
        result.piece = piece;
        result.threads = unsigned(1 + piece % 3);
        EXPECT_EQ(said(result), "");
    }
}

TEST_P(VerifierOf, NamesAPairThatIsMissing) {
    for (std::size_t i = 0; i < scene_.pairs.size(); ++i) {
        Result result = right();
        const Pair missing = result.pairs[i];
        result.pairs.erase(result.pairs.begin() + std::ptrdiff_t(i));
        EXPECT_EQ(said(result), name(missing) + " is missing");
    }
}

TEST_P(VerifierOf, NamesAPairThatIsGivenTwice) {
    for (std::size_t i = 0; i < scene_.pairs.size(); ++i) {
        Result result = right();
        const Pair twice = result.pairs[i];
        const std::size_t place = ascending() ? i : (i * 31) % result.pairs.size();
        result.pairs.insert(result.pairs.begin() + std::ptrdiff_t(place), twice);
        EXPECT_EQ(said(result), name(twice) + " was given twice");
    }
}

TEST_P(VerifierOf, NamesAPairThatDoesNotOverlap) {
    for (std::uint32_t a = 0; a < 20; ++a) {
        for (std::uint32_t b = a + 1; b < 60; ++b) {
            Result result = right();
            if (std::binary_search(scene_.pairs.begin(), scene_.pairs.end(), Pair{a, b})) continue;
            const auto place = ascending() ? std::lower_bound(result.pairs.begin(), result.pairs.end(), Pair{a, b})
                                           : result.pairs.begin() + (a * 57 + b) % 200;
            result.pairs.insert(place, {a, b});
            EXPECT_EQ(said(result), name({a, b}) + " does not overlap");
        }
    }
}

TEST_P(VerifierOf, NamesAPairOfNoObjects) {
    for (const Pair wrong : {Pair{0, 120}, Pair{120, 121}, Pair{~0u, 1}, Pair{1, ~0u}, Pair{119, ~0u}}) {
        for (const std::size_t place : {std::size_t(0), scene_.pairs.size() / 2, scene_.pairs.size()}) {
            Result result = right();
            result.pairs.insert(result.pairs.begin() + std::ptrdiff_t(place), wrong);
            const std::string words = said(result);
            EXPECT_TRUE(words.starts_with(name(wrong))) << words;
            EXPECT_TRUE(has_text(words, "the number of objects"));
        }
    }
}

TEST_P(VerifierOf, NamesAPairThatIsTurned) {
    if (GetParam().join) return;
    for (std::size_t i = 0; i < scene_.pairs.size(); i += 3) {
        Result result = right();
        Pair& pair = result.pairs[i];
        std::swap(pair.a, pair.b);
        EXPECT_EQ(said(result), name(pair) + ": a is not below b");
    }
    Result result = right();
    result.pairs.front() = {3, 3};
    EXPECT_EQ(said(result), "pair (3, 3): a is not below b");
}

TEST_P(VerifierOf, NamesWhatIsOutOfOrder) {
    for (std::size_t i = 0; i + 1 < scene_.pairs.size(); ++i) {
        Result result = right();
        std::swap(result.pairs[i], result.pairs[i + 1]);
        EXPECT_EQ(said(result), ascending() ? name(result.pairs[i + 1]) + " comes after " + name(result.pairs[i]) : "");
    }
}

TEST_P(VerifierOf, FindsOneMissingAndAnotherGivenTwice) {
    for (std::size_t i = 0; i + 1 < scene_.pairs.size(); i += 5) {
        Result result = right();
        result.pairs[i] = result.pairs[i + 1];
        const std::string words = said(result);
        EXPECT_NE(words, "");
        if (ascending()) {
            EXPECT_EQ(words, name(result.pairs[i]) + " was given twice");
        }
    }
}

TEST_P(VerifierOf, FindsThatAllAreMissing) {
    Result result = right();
    result.pairs.clear();
    const std::string words = said(result);
    if (ascending() || GetParam().list) {
        EXPECT_EQ(words, name(scene_.pairs[0]) + " is missing");
    }
    EXPECT_NE(words, "");
}

TEST_P(VerifierOf, ChecksALimitedResult) {
    const std::size_t all = scene_.pairs.size();
    for (std::size_t limit = 0; limit <= all + 1; limit += limit < 40 || limit > all - 5 ? 1 : 11) {
        Result result = right();
        result.limit = limit;
        result.truncated = limit < all;
        result.pairs.resize(std::min(limit, all));
        EXPECT_EQ(said(result), "") << limit;
        result.truncated = !result.truncated;
        EXPECT_NE(said(result), "") << limit << ": the flag is wrong";
        result.truncated = !result.truncated;
        if (limit == 0 || limit >= all) continue;
        result.pairs.pop_back();
        EXPECT_NE(said(result), "") << limit << ": a pair is missing";
        if (limit < 2) continue;
        result.pairs.insert(result.pairs.begin() + std::ptrdiff_t(limit / 2), result.pairs[limit / 4]);
        EXPECT_NE(said(result), "") << limit << ": a pair is given twice";
        if (!ascending()) continue;
        result = right();
        result.limit = limit;
        result.truncated = true;
        result.pairs.resize(limit + 1);
        const Pair missing = result.pairs[limit / 2];
        result.pairs.erase(result.pairs.begin() + std::ptrdiff_t(limit / 2));
        EXPECT_EQ(said(result), name(missing) + " is missing") << limit;
    }
}

std::string setting_name(const ::testing::TestParamInfo<Setting>& info) {
    return std::string(info.param.kind == ResultKind::octal ? "Octal" : "Ascending") +
           (info.param.list ? "List" : "Stream") + (info.param.join ? "Join" : "");
}

INSTANTIATE_TEST_SUITE_P(
    Results, VerifierOf,
    ::testing::Values(Setting{ResultKind::ascending, false, false}, Setting{ResultKind::ascending, true, false},
                      Setting{ResultKind::ascending, false, true}, Setting{ResultKind::octal, false, false},
                      Setting{ResultKind::octal, false, true}, Setting{ResultKind::octal, true, false},
                      Setting{ResultKind::octal, true, true}),
    setting_name);

TEST(Verifier, ChecksACount) {
    const Scene scene(120, false);
    const std::uint64_t all = scene.pairs.size();
    const auto said = [&](std::uint64_t pairs, bool truncated, std::optional<std::uint64_t> limit) {
        Verifier verifier({.objects = scene.searched(), .kind = ResultKind::count, .limit = limit, .threads = 1});
        return error_if_any(ErrorCode::engine_failed, [&] { EXPECT_TRUE(verifier.finish({pairs, truncated}).done); });
    };
    EXPECT_EQ(said(all, false, {}), "");
    EXPECT_EQ(said(all, false, all), "");
    EXPECT_EQ(said(all - 1, true, all - 1), "");
    EXPECT_EQ(said(0, true, 0), "");
    EXPECT_EQ(said(all - 1, false, {}), "verification failed: " + std::to_string(all - 1) +
                                            " pairs were counted, but there are " + std::to_string(all));
    EXPECT_NE(said(all + 1, false, {}), "");
    EXPECT_NE(said(all, true, all), "");
    EXPECT_NE(said(all - 1, false, all - 1), "");
    EXPECT_NE(said(all - 2, true, all - 1), "");
    EXPECT_NE(said(all - 1, true, {}), "");
}

TEST(Verifier, RowsThatArriveInManyPieces) {
    std::vector<Box3f> boxes(1200, Box3f{{0, 0, 0}, {1, 1, 1}});  // 719,400 pairs: more than are compared at once
    const Objects objects{boxes, {}};
    std::vector<Pair> pairs = baselines::oracle_pairs(objects);
    for (const std::size_t missing : {pairs.size(), std::size_t(0), std::size_t(500'000), pairs.size() - 1}) {
        std::vector<Pair> given = pairs;
        if (missing < pairs.size()) given.erase(given.begin() + std::ptrdiff_t(missing));
        Verifier verifier({.objects = {objects, nullptr, 0}, .kind = ResultKind::ascending, .threads = 2});
        const auto check = [&] {
            const std::span<const Pair> all = given;
            for (std::size_t i = 0; i < all.size(); i += 997) {
                verifier.take(all.subspan(i, std::min<std::size_t>(997, all.size() - i)));
            }
            (void)verifier.finish({all.size(), false});
        };
        if (missing == pairs.size()) {
            check();
        } else {
            EXPECT_THROW(check(), Error);
        }
    }
}

TEST(Verifier, FindsAnInvalidBoxThatWasNotRefused) {
    std::vector<Box3f> boxes(100, Box3f{{0, 0, 0}, {1, 1, 1}});
    boxes[40].max[1] = std::numeric_limits<float>::quiet_NaN();
    const Objects objects{boxes, {}};
    Verifier verifier({.objects = {objects, nullptr, 0}, .kind = ResultKind::count});
    EXPECT_EQ(error_of(ErrorCode::engine_failed,
                       [&] {
                           (void)verifier.finish({0, false});
                       }),
              "verification failed: the box of object 40 is not valid, but the engine accepted it");
}

}  // namespace
}  // namespace octopair::test
