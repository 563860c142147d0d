// SearchedStates: which state of the searched boxes each octree of a scene describes, and which state its pairs describe.
//
// Each state of the boxes has a number, and each change of the boxes makes a new state. A holder, which is an octree or the list of pairs,
// has the number of the state that it describes. It describes the current boxes if this number is that of the current state. So a change
// of the boxes needs no access to the holders.
#pragma once

#include <array>
#include <cstdint>

namespace octopair {

class SearchedStates {
public:
    enum Holder : std::uint8_t { linear, octree, pairs };

    /// The boxes may change: from now on no holder describes the current boxes.
    void change() { now_ = ++latest_; }
    /// The boxes did not change: they are those of the last step. Requires: has_stepped().
    void set_unchanged() { now_ = last_step_; }
    /// A step has ended with the current boxes.
    void end_step() { last_step_ = now_; }

    /// From now on the holder describes no state: it is about to change, or its contents are not needed.
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
