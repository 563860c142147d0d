// Random calls of an engine. Each call has its own seed, so that a test can repeat it alone.
//
// Replay: OCTOPAIR_TEST_SEED=<the seed that a failure printed> makes every property test run that case only.
// Soak:   OCTOPAIR_TEST_CASES=<number> sets the number of cases of each kind.
//         OCTOPAIR_TEST_SHARE=<per cent> sets a share of the default number.
//         OCTOPAIR_TEST_SMALL_SCENES and OCTOPAIR_TEST_LARGE_SCENES=<number> set the numbers for exactness tests.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "octopair/octopair.hpp"
#include "support/calls.hpp"

namespace octopair::test {

/// Owns the objects of a call.
struct OwnedObjects {
    std::variant<std::vector<Box3f>, std::vector<Box3d>> boxes;
    std::vector<double> padding;

    Objects view() const;
};

/// A random call: its objects and options.
struct Case {
    OwnedObjects first;
    std::optional<OwnedObjects> second;  ///< second set of a join
    double margin = 0;
    std::uint64_t limit = 0;         ///< for calls with a limit; may exceed the number of pairs
    std::uint64_t buffer_bytes = 0;  ///< for calls that stream
    unsigned threads[3] = {};        ///< 1 to 8

    std::string describe() const;
    /// Returns the input of the call. Borrows the objects.
    Input input() const;
};

/// Makes a case of 0 to 3,000 objects, mostly few. Kinds with many pairs get fewer objects.
Case make_case(const std::string& kind, std::uint64_t seed);

/// A call with the objects of a case, by any engine.
struct AnyCall {
    const Case& asked;
    Order order;
    bool streamed;
    bool limited;
    bool verify = false;

    Options options() const {
        Options options{.order = order, .margin = asked.margin, .buffer_bytes = asked.buffer_bytes, .verify = verify};
        if (limited) options.limit = asked.limit;
        return options;
    }
    std::vector<Pair> made_by(Engine& engine) const {
        return streamed ? streamed_pairs(engine, asked.input(), options())
                        : listed_pairs(engine, asked.input(), options());
    }
    std::uint64_t counted_by(Engine& engine) const { return engine.count_pairs(asked.input(), options()); }
};

/// Returns the seed of the i-th case of a kind, or OCTOPAIR_TEST_SEED.
std::uint64_t case_seed(const std::string& kind, std::uint64_t i);
/// Returns the number of cases of a kind to run: `usual`, or the number that the environment sets.
std::uint64_t case_count(std::uint64_t usual);

/// The scenes [begin, end) of a test of exactness, numbered by their seeds.
struct SceneRange {
    std::uint64_t begin, end;
    std::uint64_t size() const { return end - begin; }
    /// Returns the i-th of `parts` parts.
    SceneRange part(std::uint64_t i, std::uint64_t parts) const;
};
enum class SceneSize : std::uint8_t { small, large };
/// Returns `usual` scenes, the number of scenes that the environment sets (fewer under sanitizers), or only the scene
/// of OCTOPAIR_TEST_SEED.
SceneRange scene_range(SceneSize size, std::uint64_t usual);

}  // namespace octopair::test
