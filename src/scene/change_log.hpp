// ChangeLog: the states that changed objects had at the last step.
//
// Invariants
//   An object has at most one entry in the log: its state before its first change since the last step.
//   ObjectTable::mark() of an object is the position of its entry, or `none` if it has no entry.
//   A log that overflowed is empty. The next step then searches all objects and needs no log.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "base/growing_array.hpp"
#include "base/test_hooks.hpp"
#include "base/tuning.hpp"
#include "scene/object_table.hpp"

namespace octopair {

/// State of an object before its first change since the last step.
struct PreviousState {
    std::uint32_t index;
    ObjectState state;
};

class ChangeLog {
public:
    /// Reserves memory for `changes` calls of note(), so that these calls cannot fail. If so many changes do not fit, the log overflows.
    void reserve(ObjectTable& table, std::uint64_t changes) noexcept {
        if (overflowed_) return;
        if (double(previous_states_.size() + changes) >= most(table)) return overflow(table);
        try {
            reserve_more(previous_states_, std::size_t(changes));
        } catch (...) {
            overflow(table);
        }
    }
    /// Logs the state of an object, unless it is in the log already.
    /// Requires: reserve() has been called; the object has not changed yet, or was just created (`existed` is false).
    void note(ObjectTable& table, std::uint32_t index, bool existed) {
        if (overflowed_ || table.mark(index) != ObjectTable::none) return;
        table.set_mark(index, std::uint32_t(previous_states_.size()));
        previous_states_.push_back({index, table.state(index)});
        previous_states_.back().state.exists = existed;
    }

    /// Returns the state of an object at the last step if it has changed since, otherwise null.
    const ObjectState* previous_state(const ObjectTable& table, std::uint32_t index) const {
        const std::uint32_t mark = table.mark(index);
        return mark == ObjectTable::none ? nullptr : &previous_states_[mark].state;
    }
    std::span<const PreviousState> previous_states() const { return previous_states_; }
    /// Returns whether more objects changed than the log holds.
    bool overflowed() const { return overflowed_; }

    /// Empties the log and marks it as overflowed, so that note() has no effect until clear().
    void give_up(ObjectTable& table) { overflow(table); }
    /// Empties the log after a step, so that it records changes again.
    void clear(ObjectTable& table) {
        forget(table);
        overflowed_ = false;
    }

private:
    static double most(const ObjectTable& table) {
        return tuning().scene.log_part * double(table.indices()) + tuning().scene.min_log;
    }

    void overflow(ObjectTable& table) {
        count_path(Path::log_overflowed);
        forget(table);
        overflowed_ = true;
    }

    void forget(ObjectTable& table) {
        for (const PreviousState& former : previous_states_) table.set_mark(former.index, ObjectTable::none);
        previous_states_.clear();
    }

    std::vector<PreviousState> previous_states_;
    bool overflowed_ = false;
};

}  // namespace octopair
