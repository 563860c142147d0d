// ResultCheck: compares what a call delivers with what the second algorithm finds.
//
// Pairs are taken in the order of the result, in pieces of any length; finish() compares the rest. Both throw
// Error{engine_failed} that names a pair, or the object whose pairs differ.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string_view>

#include "octopair/objects.hpp"
#include "verification/row_pass.hpp"

namespace octopair {

/// How a call says that it ended.
struct CallEnd {
    std::uint64_t pairs = 0;                             ///< as the summary says
    bool truncated = false;                              ///< as the summary says
    std::span<const std::span<const Pair>> chunks = {};  ///< all pairs once more, where a list has them; else empty
};

class ResultCheck {
public:
    virtual ~ResultCheck() = default;

    /// Not thread-safe.
    virtual void take(std::span<const Pair> pairs) = 0;
    /// Call once, after the last pair.
    virtual void finish(const CallEnd& end) = 0;
    /// Returns text for users that names what this check cannot find in such a result; empty if it finds everything.
    virtual std::string_view not_checked(const CallEnd& end) const = 0;
};

/// Ascending order. Exact: each row is compared, pair by pair, once its last pair was taken. Names the first pair in
/// which the result differs. Memory: 1 MiB and the pairs of one object.
std::unique_ptr<ResultCheck> make_ascending_check(const RowPass& pass);

/// Any order. Each pair is judged by the pair rule when it is taken, so that one that does not belong is named at once.
/// For each object the number of its pairs and a sum (mod 2^64) of hashes of their b are compared at the end: pairs that
/// are missing or were given twice pass unseen with a probability of 2^-128. Of a truncated result an object's pairs
/// may be fewer, and then those given twice are found if the limit is at most 2^20 or one pair an object: all are kept.
/// Memory: 12 bytes an object, and what is kept.
std::unique_ptr<ResultCheck> make_set_check(const RowPass& pass, std::optional<std::uint64_t> limit);

/// The number of pairs alone. Memory: none.
std::unique_ptr<ResultCheck> make_count_check(const RowPass& pass);

}  // namespace octopair
