// Calls of every kind, as data: what tests ask an engine, and what it answers.
#pragma once

#include <optional>
#include <stop_token>
#include <string>
#include <vector>

#include "octopair/octopair.hpp"

namespace octopair::test {

enum class How { list, stream, count };

/// One call.
struct Asked {
    How how = How::list;
    Order order = Order::octal;
    bool windows = false;  ///< of a stream: a buffer that holds only some of the pairs
    bool join = false;
    bool padded = false;
    bool wide = false;  ///< float64
    double margin = 0;
    std::optional<std::uint64_t> limit = {};

    std::string describe() const;
};

/// Objects that calls are about; `second` is the other set of a join.
struct Scene {
    std::string kind;
    std::vector<Box3f> first, second;
    std::vector<Box3d> wide_first, wide_second;
    std::vector<double> padding;

    /// `kind`: of samples; "crowd", where one of 40 objects is in one place; or "speck", where 7 of 8 objects are in one
    /// octant, which is large enough from 38,000 objects on for workers to share its nested octree.
    Scene(const std::string& kind, std::uint64_t objects, std::uint64_t seed);
    Objects objects(const Asked& asked) const;
    Objects others(const Asked& asked) const;
};

struct Answer {
    std::vector<Pair> pairs;  ///< not of a count
    std::uint64_t count = 0;
    bool truncated = false;

    bool operator==(const Answer&) const = default;
};

/// Throws what the call does.
Answer ask(Engine& engine, const Scene& scene, const Asked& asked, std::stop_token stop = {});

/// Expects the same pairs in the same order, and all else the same.
void expect_same(const Answer& found, const Answer& expected);
/// Expects that the engine answers what a local one does. Throws what the call does.
void expect_right(Engine& engine, const Scene& scene, const Asked& asked);

/// All ways to ask: list, stream and count, both orders.
std::vector<Asked> all_ways();

/// Some call, drawn from `seed`.
Asked random_call(std::uint64_t seed);

}  // namespace octopair::test
