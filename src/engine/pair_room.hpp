// PairRoom: compares the number of pairs of a call with what its receiver has room for, so that a call whose result cannot fit fails early.
// The room is Output::max_pairs and, for a list, the memory that this process can still get.
//
// 1. While pairs are found, a forecast compares them with the part of the octree that was scanned. If all pairs may be too many, the
//    engine abandons the scan and counts the pairs, which is many times faster and takes no memory.
// 2. require() refuses a number of pairs that does not fit. Otherwise the engine scans again.
// 3. A list is refused a block of memory that is larger than the free memory.
//
// So only certain numbers refuse a call. A forecast alone never does, and no list below `unchecked_bytes` (tuning.hpp) is checked.
#pragma once

#include <cstdint>
#include <optional>

#include "engine/pair_count.hpp"
#include "engine/pair_list.hpp"
#include "engine/progress.hpp"
#include "engine/request.hpp"

namespace octopair {

/// End of each message about a list that does not fit.
inline constexpr const char* list_advice = "; use count_pairs, limit or stream_pairs";

/// Thread safety: one thread at a time. The list calls its part of this object from any thread, but from one at a time.
class OCTOPAIR_PRIVATE_EXPORT PairRoom {
public:
    /// Bounds on the number of pairs: Options::limit, and Output::max_pairs.
    struct Bounds {
        std::optional<std::uint64_t> limit, max_pairs = {};
    };
    /// Watches the list's blocks of memory until destruction. `list`: null for a sink. `forecasts`: false for an engine that cannot scan
    /// again. Borrows the other arguments.
    PairRoom(const Bounds& bounds, detail::PairStorage* list, const Progress& progress, bool forecasts = true);
    ~PairRoom();
    PairRoom(const PairRoom&) = delete;
    PairRoom& operator=(const PairRoom&) = delete;

    /// Returns true if the engine can still abandon the scan that fills the list, to count the pairs. A receiver fills a list with a limit
    /// and calls is_doubtful().
    bool can_count() const { return forecasts_ && list_ != nullptr && !bounds_.limit; }
    /// Must be called before check(), require() and count_limit() if the pairs of the list are in memory that the engine has mapped. `bytes`:
    /// memory that they have; `most`: bytes that are mapped for them.
    void hold(std::uint64_t bytes, std::uint64_t most);
    /// Checks a list of `pairs` pairs so far. Throws: OverBudget if all pairs may be too many; TooManyPairs if no memory is free.
    void check(std::uint64_t pairs);
    /// Returns true if a scan that has found `pairs` pairs for a stream may find too many.
    bool is_doubtful(std::uint64_t pairs);
    /// Returns how far the pairs must be counted from now on.
    CountLimit count_limit() const;
    /// Must be called when the number of pairs of the call, or of a part of its rows, is known. Ends the forecasts.
    /// Throws: TooManyPairs if the pairs do not fit.
    void require(PairCount all);

private:
    std::optional<std::uint64_t> free() const;
    std::uint64_t held() const;
    std::uint64_t room_bytes(std::uint64_t more) const;
    std::optional<std::uint64_t> most_in_memory() const;
    bool will_exceed(std::uint64_t pairs, std::uint64_t most) const;
    void grow(std::uint64_t bytes);
    void check_memory(std::uint64_t pairs, std::uint64_t bytes);

    const Bounds bounds_;
    detail::PairStorage* const list_;
    const Progress& progress_;
    bool forecasts_;
    bool mapped_ = false;               // the engine has mapped memory for the pairs
    std::uint64_t held_by_engine_ = 0;  // bytes of the pairs in the engine's memory
    std::uint64_t most_bytes_;          // upper bound on held()
    std::uint64_t next_check_;          // value of held() at which it is compared with the free memory
    std::uint64_t next_forecast_;       // number of streamed pairs at which they are compared with the free memory
};

}  // namespace octopair
