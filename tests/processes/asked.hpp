// Calls of every kind as data: the arguments of a call and its answer.
#pragma once

#include <optional>
#include <stop_token>
#include <string>
#include <vector>

#include "octopair/octopair.hpp"

namespace octopair::test {

enum class How { list, stream, count };

/// The arguments of a call.
struct Asked {
    How how = How::list;
    Order order = Order::octal;
    bool windows = false;  ///< the buffer has 0 bytes, so a stream delivers the pairs in several windows
    bool join = false;
    bool padded = false;
    bool wide = false;  ///< boxes in float64
    double margin = 0;
    std::optional<std::uint64_t> limit = {};

    std::string describe() const;
};

/// The objects of calls. `second` is the second set of a join.
struct Scene {
    std::string kind;
    std::vector<Box3f> first, second;
    std::vector<Box3d> wide_first, wide_second;
    std::vector<double> padding;

    /// `kind`: a kind of samples, "crowd" or "speck". "crowd": "uniform", with 1 of 40 objects from "coincident".
    /// "speck": 7 of 8 objects are in one octant. From 38,000 objects on, workers share the nested octree of that
    /// octant.
    Scene(const std::string& kind, std::uint64_t objects, std::uint64_t seed);
    Objects objects(const Asked& asked) const;
    Objects others(const Asked& asked) const;
};

struct Answer {
    std::vector<Pair> pairs;  ///< empty for How::count
    std::uint64_t count = 0;
    bool truncated = false;

    bool operator==(const Answer&) const = default;
};

/// Makes the call and returns its answer. Throws: the call's Error.
Answer ask(Engine& engine, const Scene& scene, const Asked& asked, std::stop_token stop = {});

/// Expects the same pairs in the same order, and equal counts and truncation.
void expect_same(const Answer& found, const Answer& expected);
/// Expects that the engine answers as a local engine does. Throws: the call's Error.
void expect_right(Engine& engine, const Scene& scene, const Asked& asked);

/// Returns all kinds of calls: list, stream and count, in both orders.
std::vector<Asked> all_ways();

/// Returns a random call, drawn from `seed`.
Asked random_call(std::uint64_t seed);

}  // namespace octopair::test
