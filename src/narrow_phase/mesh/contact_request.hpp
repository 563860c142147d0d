// ContactRequest: limits of the search for contacts of two objects that meet.
#pragma once

#include <cstdint>
#include <stop_token>

namespace octopair {

struct ContactRequest {
    std::uint32_t max_contacts;  ///< maximum number of contacts in the result
    /// After a stop request the search ends soon; its result is then unspecified. Borrowed.
    const std::stop_token& stop;
};

}  // namespace octopair
