// The table that maps each ErrorCode to its representations outside C++: a name, the exit status of the program, and the gRPC
// status of a call to a server.
// Start here to add a new error code.
#pragma once

#include <array>
#include <cstddef>
#include <string_view>

#include "octopair/error.hpp"

namespace octopair {

struct ErrorCodeRow {
    ErrorCode code;
    std::string_view name;
    int exit_status;
    int grpc_status;  ///< https://grpc.io/docs/guides/status-codes/
};

/// Rows are in the order of the enumeration.
inline constexpr std::array<ErrorCodeRow, 6> error_code_table = {{
    {ErrorCode::usage, "usage", 2, 3},
    {ErrorCode::bad_input, "bad input", 3, 3},
    {ErrorCode::io_failed, "I/O failed", 4, 15},
    {ErrorCode::resource_limit, "resource limit", 5, 8},
    {ErrorCode::engine_failed, "engine failed", 6, 13},
    {ErrorCode::cancelled, "cancelled", 130, 1},
}};

static_assert([] {
    for (std::size_t i = 0; i < error_code_table.size(); ++i) {
        if (std::size_t(error_code_table[i].code) != i) return false;
    }
    return true;
}());

constexpr const ErrorCodeRow& error_code_row(ErrorCode code) { return error_code_table[std::size_t(code)]; }
constexpr int exit_status(ErrorCode code) { return error_code_row(code).exit_status; }
constexpr std::string_view error_name(ErrorCode code) { return error_code_row(code).name; }

}  // namespace octopair
