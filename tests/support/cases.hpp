// Random calls of an engine, each from one seed, so that any can be run again alone.
//
// Replay: OCTOPAIR_TEST_SEED=<the seed that a failure printed> makes every property test run that one case.
// Soak:   OCTOPAIR_TEST_CASES=<number> runs so many cases of each kind instead of the usual number;
//         OCTOPAIR_TEST_SHARE=<per cent> a share of the usual number;
//         OCTOPAIR_TEST_SMALL_SCENES and OCTOPAIR_TEST_LARGE_SCENES=<number> do so for the tests of exactness.
#pragma once

#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "octopair/octopair.hpp"

namespace octopair::test {

/// The objects of a call, owned.
struct OwnedObjects {
    std::variant<std::vector<Box3f>, std::vector<Box3d>> boxes;
    std::vector<double> padding;

    Objects view() const;
};

/// One random call: what is searched, and how.
struct Case {
    OwnedObjects first;
    std::optional<OwnedObjects> second;  ///< of a join
    double margin = 0;
    std::uint64_t limit = 0;         ///< for the calls with a limit; may be more than there are
    std::uint64_t buffer_bytes = 0;  ///< for the calls that stream
    unsigned threads[3] = {};        ///< 1 to 8

    std::string describe() const;
    /// Returns what a call is given. Borrows the objects.
    Input input() const;
};

/// Objects 0 to 3,000, mostly few; kinds whose pairs are many get fewer.
Case make_case(const std::string& kind, std::uint64_t seed);

/// The seed of the i-th case of a kind, or OCTOPAIR_TEST_SEED.
std::uint64_t case_seed(const std::string& kind, std::uint64_t i);
/// How many cases of a kind to run: `usual`, or what the environment asks for.
std::uint64_t case_count(std::uint64_t usual);

/// The scenes [begin, end) that a test of exactness checks, numbered by their seeds.
struct SceneRange {
    std::uint64_t begin, end;
    std::uint64_t size() const { return end - begin; }
    /// The i-th of `parts` parts.
    SceneRange part(std::uint64_t i, std::uint64_t parts) const;
};
enum class SceneSize : std::uint8_t { small, large };
/// `usual` scenes, as many as the environment asks for (fewer under sanitizers), or the one of OCTOPAIR_TEST_SEED.
SceneRange scene_range(SceneSize size, std::uint64_t usual);

}  // namespace octopair::test
