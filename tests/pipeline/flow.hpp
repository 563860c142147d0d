// Helpers for tests of pipelines: a filter that records a number for each pair, and the collected output of a pipeline.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "octopair/filters.hpp"
#include "octopair/pipeline.hpp"
#include "samples/scenes.hpp"
#include "support/compare.hpp"

namespace octopair::test {

/// Returns a pseudo-random number that depends on the pair only.
inline std::uint64_t lot(Pair pair) {
    const std::uint64_t mixed = (std::uint64_t(pair.a) << 32 | pair.b) * 0x9E3779B97F4A7C15u;
    return mixed ^ mixed >> 29;
}

/// Keeps every pair whose lot is not divisible by `divisor`, and records the lot in the pair's finding.
class LotFilter final : public Filter {
public:
    explicit LotFilter(std::uint64_t divisor) : divisor_(divisor) {}
    std::string_view name() const override { return "lot"; }
    void apply(Batch& batch) const override {
        batch.keep_if([&](std::size_t i) {
            const std::uint64_t drawn = lot(batch.pairs()[i]);
            if (drawn % divisor_ == 0) return false;
            batch.finding(i).note = drawn;
            return true;
        });
    }

private:
    std::uint64_t divisor_;
};

/// Pairs and their findings, in the order of output.
struct Outcome {
    std::vector<Pair> pairs;
    std::vector<std::uint64_t> notes;
};

inline void expect_same(const Outcome& found, const Outcome& expected) {
    EXPECT_TRUE(same_sequence(found.pairs, expected.pairs));
    EXPECT_TRUE(same_sequence(found.notes, expected.notes));
}

inline CollisionSink into(Outcome& outcome) {
    return [&outcome](const Batch& batch) {
        outcome.pairs.insert(outcome.pairs.end(), batch.pairs().begin(), batch.pairs().end());
        for (const Finding& finding : batch.findings()) outcome.notes.push_back(finding.note);
    };
}

inline Objects all_of(const std::vector<Box3f>& boxes) { return {boxes}; }

}  // namespace octopair::test
