// SearchedStates: which state of the searched boxes each octree of a scene describes, and which one its pairs describe.
//
// A state is a number, and each change makes a new one. So nothing that holds boxes must be told when they change: it holds the current
// boxes if its number is the current one, and those of the last step if its number is that of the last step.
#pragma once

#include <array>
#include <cstdint>

namespace octopair {

class SearchedStates {
public:
    enum Holder : std::uint8_t { linear, octree, pairs };

    /// The boxes may change: no holder has the current ones any more.
    void change() { now_ = ++latest_; }
    /// The boxes are those of the last step after all. Requires: has_stepped().
    void set_unchanged() { now_ = last_step_; }
    /// A step has ended with the current boxes.
    void end_step() { last_step_ = now_; }

    /// A holder is about to change, or what it has is not wanted.
    void forget(Holder holder) { held_[holder] = none; }
    void hold_now(Holder holder) { held_[holder] = now_; }
    /// Requires: has_stepped().
    void hold_last_step(Holder holder) { held_[holder] = last_step_; }

    bool has_stepped() const { return last_step_ != none; }
    bool is_now(Holder holder) const { return held_[holder] == now_; }
    bool is_last_step(Holder holder) const { return has_stepped() && held_[holder] == last_step_; }

private:
    static constexpr std::uint64_t none = 0;

    std::uint64_t latest_ = 1;        // largest number in use
    std::uint64_t now_ = 1;           // state of the boxes
    std::uint64_t last_step_ = none;  // their state at the last step
    std::array<std::uint64_t, 3> held_ = {none, none, none};
};

}  // namespace octopair
