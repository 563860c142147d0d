// ResultCheck: compares the pairs of a call's result with the pairs that the second algorithm (row_search.hpp) finds.
//
// take() receives the pairs in the order of the result, in pieces of any length. finish() compares the rest. Both functions throw
// Error{engine_failed} that names a wrong or missing pair, or the object whose pairs differ.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string_view>

#include "octopair/objects.hpp"
#include "verification/row_pass.hpp"

namespace octopair {

/// Result of a call, as its summary reports it.
struct CallEnd {
    std::uint64_t pairs = 0;                             ///< number of pairs in the summary
    bool truncated = false;                              ///< Summary::truncated
    std::span<const std::span<const Pair>> chunks = {};  ///< all pairs of the result if it is a list; otherwise empty
};

class ResultCheck {
public:
    virtual ~ResultCheck() = default;

    /// Receives the next pairs of the result. Thread safety: one thread at a time.
    virtual void take(std::span<const Pair> pairs) = 0;
    /// Compares the pairs that take() has not compared. Call it once, after the last pair.
    virtual void finish(const CallEnd& end) = 0;
    /// Returns a text for users that names the properties of such a result that this check does not check; empty if it checks everything.
    virtual std::string_view not_checked(const CallEnd& end) const = 0;
};

/// Returns a check of results in ascending order. Exact: compares the pairs (a, b) of each object a, pair by pair, after the last of them.
/// Names the first pair in which the result differs. Memory: 1 MiB and the pairs of one object.
std::unique_ptr<ResultCheck> make_ascending_check(const RowPass& pass);

/// Returns a check of results in any order. Each pair is tested by the pair rule when it is taken, so a wrong pair is named at
/// once. For each object, the number of its pairs and a sum (mod 2^64) of hashes of their b are compared at the end. Missing
/// and duplicate pairs are overlooked with a probability of 2^-128. In a truncated result an object may have fewer pairs. Then
/// duplicate pairs are found only if the limit is at most 2^20 or the number of objects: all pairs are kept for that.
/// Memory: 12 bytes an object, and the kept pairs.
std::unique_ptr<ResultCheck> make_set_check(const RowPass& pass, std::optional<std::uint64_t> limit);

/// Returns a check of the number of pairs alone. Memory: none.
std::unique_ptr<ResultCheck> make_count_check(const RowPass& pass);

}  // namespace octopair
