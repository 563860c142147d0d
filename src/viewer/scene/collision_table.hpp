// The table of collisions of a frame.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "viewer/scene/frame_answers.hpp"

namespace octopair::viewer {

/// Selects rows of the table of collisions.
struct RowRequest {
    std::uint64_t from = 0, count = 100;
    enum class Sort : std::uint8_t { pair, depth, began } sort = Sort::pair;
    std::optional<std::uint32_t> object;
    std::string text;
};
/// Throws: Error{bad_input} for an invalid parameter.
RowRequest row_request(const Address& address);
Answer collision_rows(const ShownFrame& frame, const RowRequest& request);

}  // namespace octopair::viewer
