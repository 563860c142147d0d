// PairHistory: the ascending list of all pairs of a scene, updated by each step.
//
// Changes of small steps are collected and merged into the list later: when a caller reads the list, or when the changes
// have become many. So a step whose list is not read has no cost for the pairs that persist.
//
// Invariants
//   `list_`, with `began_` added and `ended_` removed, has the pairs of the last step.
//   `size_` is the number of these pairs.
//   If a change contradicts the list (such as a pair that ends but is not in it), the list is inconsistent until take_over().
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "base/private_export.hpp"
#include "base/radix_sort.hpp"
#include "engine/pair_list.hpp"

namespace octopair {

/// Pairs that a step changed. Both lists are ascending. No pair is in both.
struct PairChanges {
    std::vector<Pair> began;
    std::vector<Pair> ended;

    void clear() {
        began.clear();
        ended.clear();
    }
};

/// Returns a pair as an integer. The order of the integers is that of the pairs.
inline std::uint64_t key_of(const Pair& pair) { return std::uint64_t(pair.a) << 32 | pair.b; }
inline Pair pair_of(std::uint64_t key) { return {std::uint32_t(key >> 32), std::uint32_t(key)}; }

class OCTOPAIR_PRIVATE_EXPORT PairHistory {
public:
    using Room = std::function<void(std::uint64_t bytes)>;

    /// `room` is called before memory for pairs is allocated; its exceptions reach the caller. It may be empty.
    explicit PairHistory(Room room = {});

    /// Returns a list for the caller to fill with the pairs of a full detection, in ascending order. take_over() follows.
    /// Throws: Error{engine_failed} if the merge finds that the list is inconsistent. The next call does not throw this again.
    PairList& fresh() {
        merge();  // first, because merge() uses other_ as well
        return other_;
    }
    /// Replaces the list by fresh(), and stores the differences in `changes`. The list is consistent then.
    /// Throws: Error{engine_failed} if fresh() is not ascending; then only `changes` has been modified.
    void take_over(PairChanges& changes);
    /// Allocates memory before a step, so that a lack of memory fails the step before anything has changed.
    /// `little`: the step may be incremental. Then also allocates memory for a later merge().
    /// Throws: Error{engine_failed} if the merge finds that the list is inconsistent. The next call does not throw this again.
    void prepare(bool little);
    /// Adds the changes of an incremental step. Requires: the list is consistent.
    /// Throws: Error{engine_failed} if `changes` are not ascending or end too many pairs; then nothing is modified.
    void apply(const PairChanges& changes);

    /// Returns the pairs of the last step.
    /// Throws: Error{engine_failed} if the list is inconsistent; it names the first change that contradicts the list.
    const PairList& list();
    /// Returns whether a change since the last full detection contradicts the list. Then only a full detection may follow.
    bool is_inconsistent() const { return !inconsistency_.empty(); }
    std::uint64_t size() const { return size_; }

private:
    void merge();
    void write_merged();
    void report_inconsistency(std::uint64_t key, const char* what);
    void reserve_other();
    void note(std::vector<Pair>& changes, const Pair& pair) const;

    Room room_;
    PairList list_, other_;
    std::vector<std::uint64_t> began_, ended_;  // keys of changes that are not merged into list_ yet
    RadixSort<std::uint64_t> sort_;
    std::uint64_t size_ = 0;
    bool other_reserved_ = false;  // true: other_ has memory for as many pairs as list_
    std::string inconsistency_;    // error message of the first contradiction; empty: the list is consistent
};

/// Stores in `out` the pairs of `all` that are not in `less`. Requires: both are ascending; `all` has every pair of `less`.
OCTOPAIR_PRIVATE_EXPORT void subtract(const PairList& all, std::span<const Pair> less, PairList& out);

}  // namespace octopair
