// What is asked of two objects that meet.
#pragma once

#include <cstdint>
#include <stop_token>

namespace octopair {

struct ContactRequest {
    std::uint32_t max_contacts;
    /// After a stop request the search ends soon, with any answer. Borrowed.
    const std::stop_token& stop;
};

}  // namespace octopair
