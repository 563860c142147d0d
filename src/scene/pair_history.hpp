// PairHistory: all pairs of a scene, ascending, as steps change them.
//
// A step that changes little only notes what began and ended; the list is made from these when it is asked for, or when
// they have become many. So a step whose list nobody reads costs nothing for the pairs that persist.
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "base/radix_sort.hpp"
#include "engine/pair_list.hpp"

namespace octopair {

/// Ascending, and without a pair in both.
struct PairChanges {
    std::vector<Pair> began;
    std::vector<Pair> ended;

    void clear() {
        began.clear();
        ended.clear();
    }
};

/// Pairs as integers in the same order.
inline std::uint64_t key_of(const Pair& pair) { return std::uint64_t(pair.a) << 32 | pair.b; }
inline Pair pair_of(std::uint64_t key) { return {std::uint32_t(key >> 32), std::uint32_t(key)}; }

class PairHistory {
public:
    using Room = std::function<void(std::uint64_t bytes)>;

    /// `room`: asked before memory is taken for pairs; what it throws is thrown on. May be none.
    explicit PairHistory(Room room = {});

    /// The list as it will be after a full detection: to be filled, ascending, then taken over.
    /// Throws: Error{engine_failed} like list(), but only once.
    PairList& fresh() {
        merge();  // which uses the same memory
        return other_;
    }
    /// Takes fresh() over, and tells what changed. The list is not doubtful any more.
    /// Throws: Error{engine_failed} if fresh() does not ascend; then only `changes` has been changed.
    void take_over(PairChanges& changes);
    /// Before a step, and the only thing here that may then run out of memory with no harm done. `little`: for a step
    /// that may change little.
    /// Throws: Error{engine_failed} like list(), but only once.
    void prepare(bool little);
    /// What a step changed.
    /// Throws: Error{engine_failed} if that cannot be, and then changes nothing. Requires: the list is not doubtful.
    void apply(const PairChanges& changes);

    /// Throws: Error{engine_failed} with the first change that cannot be, if the list is doubtful.
    const PairList& list();
    /// Some change since the last full detection cannot be: only a full detection may follow.
    bool is_doubtful() const { return !doubt_.empty(); }
    std::uint64_t size() const { return size_; }

private:
    void merge();
    void write_merged();
    void doubt(std::uint64_t key, const char* what);
    void settle();
    void note(std::vector<Pair>& changes, const Pair& pair) const;

    Room room_;
    PairList list_, other_;
    std::vector<std::uint64_t> began_, ended_;  // not yet in list_
    RadixSort<std::uint64_t> sort_;
    std::uint64_t size_ = 0;
    bool settled_ = false;  // other_ has memory for a list of this size
    std::string doubt_;     // why the list is doubtful; empty: it is not
};

/// The pairs of `all` without those of `less`, which are among them; both ascending. Replaces `out`.
void subtract(const PairList& all, std::span<const Pair> less, PairList& out);

}  // namespace octopair
