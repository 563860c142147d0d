#include "engine/processes/shared_memory/arena.hpp"

#include <algorithm>
#include <string>

#include "octopair/error.hpp"

namespace octopair {

void* Arena::reserve(std::size_t bytes) {
    constexpr std::uint64_t page = 4096;  // arrays never share a page
    if (bytes > memory_.size() - used_) {
        throw Error(ErrorCode::resource_limit, "shared memory: " + std::to_string(bytes) +
                                                   " more bytes do not fit into " + std::to_string(memory_.size()));
    }
    void* const reserved = memory_.data() + used_;
    used_ = std::min(memory_.size(), (used_ + bytes + page - 1) / page * page);
    return reserved;
}

}  // namespace octopair
