// Writes random bytes into the memory that a worker shares with the client.
#pragma once

#include <cstdint>
#include <memory>

#include "engine/processes/worker/work_sharing.hpp"

namespace octopair::test {

/// Returns an observer that writes random bytes into the tables of the control block, at times while shares run. The
/// writes depend on the seed, the slot, the process and the times of the shares.
std::unique_ptr<ShareObserver> make_damage(std::uint64_t seed, unsigned slot);

}  // namespace octopair::test
