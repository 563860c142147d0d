// Nonsense in the memory that a worker shares with the client.
#pragma once

#include <cstdint>
#include <memory>

#include "engine/processes/worker/work_sharing.hpp"

namespace octopair::test {

/// Writes random bytes into the tables of the control block, now and then while shares are under way. A function of the seed, the
/// slot, the process and of when shares come.
std::unique_ptr<ShareObserver> make_damage(std::uint64_t seed, unsigned slot);

}  // namespace octopair::test
