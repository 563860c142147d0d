// StepSnapshot: a copy of a scene's state after a step, for the watchers of the scene.
#pragma once

#include <cstddef>
#include <cstdint>

#include "base/memory.hpp"
#include "octopair/scene.hpp"
#include "service/server/jobs/budget.hpp"

namespace octopair::service {

/// Numbers of a step, and of the scene after it.
struct StepNumbers {
    std::uint64_t step = 0;  ///< the first step is 1; 0: no step yet
    std::uint64_t objects = 0;
    std::uint64_t pairs = 0;
    std::uint64_t began = 0;
    std::uint64_t ended = 0;
    double seconds = 0;
};

/// Not changed after it is made, so any thread may read it.
struct StepSnapshot {
    Budget::Reservation memory;
    StepNumbers numbers;
    Precision precision = Precision::float32;
    std::uint64_t indices = 0;
    std::uint64_t listed = 0;    ///< number of pairs in `data`
    std::uint64_t pairs_at = 0;  ///< offset of the first pair in `data`, in bytes
    Buffer<std::byte> data;      ///< presence, boxes and pairs, as in octopair.proto's SceneSnapshot

    /// Returns whether the snapshot has as many pairs as a watcher with this limit gets.
    bool lists(std::uint64_t pair_limit) const { return listed >= pair_limit || listed == numbers.pairs; }
};

}  // namespace octopair::service
