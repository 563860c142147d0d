// ChangeLog: what the objects that changed since the last step were before.
//
// It keeps no more than a part of the objects; beyond, a step searches all and does not need it.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "base/reserve.hpp"
#include "base/test_hooks.hpp"
#include "base/tuning.hpp"
#include "scene/object_table.hpp"

namespace octopair {

/// An object before its first change since the last step.
struct PreviousState {
    std::uint32_t index;
    ObjectState state;
};

class ChangeLog {
public:
    /// Before a call that changes so many objects: whether they fit is known at once, and note() does not fail.
    void expect(ObjectTable& table, std::uint64_t changes) noexcept {
        if (overflowed_) return;
        if (double(formers_.size() + changes) >= most(table)) return overflow(table);
        try {
            reserve_more(formers_, std::size_t(changes));
        } catch (...) {
            overflow(table);
        }
    }
    /// To be called before a change of an object, or after it was created (`existed` false), which was expected.
    void note(ObjectTable& table, std::uint32_t index, bool existed) {
        if (overflowed_ || table.mark(index) != ObjectTable::none) return;
        table.set_mark(index, std::uint32_t(formers_.size()));
        formers_.push_back({index, table.state(index)});
        formers_.back().state.exists = existed;
    }

    std::span<const PreviousState> formers() const { return formers_; }
    /// More has changed than is kept.
    bool overflowed() const { return overflowed_; }

    /// Nothing is kept until clear().
    void give_up(ObjectTable& table) { overflow(table); }
    /// After a step.
    void clear(ObjectTable& table) {
        forget(table);
        overflowed_ = false;
    }

private:
    static double most(const ObjectTable& table) {
        return tuning().scene.log_part * double(table.indices()) + tuning().scene.log_least;
    }

    void overflow(ObjectTable& table) {
        count_path(Path::log_overflowed);
        forget(table);
        overflowed_ = true;
    }

    void forget(ObjectTable& table) {
        for (const PreviousState& former : formers_) table.set_mark(former.index, ObjectTable::none);
        formers_.clear();
    }

    std::vector<PreviousState> formers_;
    bool overflowed_ = false;
};

}  // namespace octopair
