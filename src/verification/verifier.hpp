// Verifier: checks the result of one call by the second algorithm (row_search.hpp).
#pragma once

#include <memory>
#include <optional>
#include <span>
#include <stop_token>

#include "octopair/objects.hpp"
#include "octopair/options.hpp"
#include "octopair/summary.hpp"
#include "parallel/team.hpp"
#include "verification/result_check.hpp"
#include "verification/row_search.hpp"

namespace octopair {

/// The kind of result that is compared with the second algorithm.
enum class ResultKind : std::uint8_t { ascending, octal, count };

class Verifier {
public:
    struct Setup {
        SearchedObjects objects;  ///< borrowed
        ResultKind kind = ResultKind::ascending;
        std::optional<std::uint64_t> limit = {};
        unsigned threads = 0;  ///< 0: one per core
        std::stop_token stop = {};
    };
    explicit Verifier(const Setup& setup) : setup_(setup) {}

    /// Takes the next pairs of the result, in pieces of any length. Requires: the engine has accepted the objects.
    /// Throws: Error{engine_failed} that names a pair; Error{cancelled}, std::bad_alloc.
    void take(std::span<const Pair> pairs);
    /// Checks the rest. Call once, after the last pair. Throws: as take().
    Verification finish(const CallEnd& end);

    /// Sets a function that receives the progress of the check from now on, 0 to 1. May be empty.
    void set_progress(ProgressSink progress) { progress_ = std::move(progress); }
    /// Returns the wall-clock time spent in take() and finish().
    double seconds() const { return seconds_; }

private:
    struct Parts;
    ResultCheck& check();
    void check_numbers(const CallEnd& end) const;

    Setup setup_;
    ProgressSink progress_;
    std::shared_ptr<Parts> parts_;  // null before the first pair
    std::uint64_t taken_ = 0;
    double seconds_ = 0;
};

}  // namespace octopair
