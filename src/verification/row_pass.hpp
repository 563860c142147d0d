// RowPass: runs the second algorithm (row_search.hpp) row by row on the threads of a team, and visits each row. A row is all pairs
// (a, b) of one object a. A visit may report a fault of the checked result.
//
// Result     the fault of the lowest row in which a visit reported a fault, so the result does not depend on threads.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <stop_token>
#include <string>

#include "octopair/objects.hpp"
#include "octopair/options.hpp"
#include "parallel/team.hpp"
#include "verification/row_search.hpp"

namespace octopair {

/// Message for users that describes a fault of a result; none if there is no fault.
using ResultFault = std::optional<std::string>;

/// Throws: Error{engine_failed} with this message.
[[noreturn]] void throw_verification_failed(const std::string& message);

/// Returns a name such as "pair (12, 40)".
std::string name_of_pair(const Pair& pair);

/// Returns whether both numbers of a pair name objects: a < rows, b < columns, and a < b within one set.
bool has_position(const RowSearch& rows, const Pair& pair);
/// Returns a message that says why has_position() is false. Requires: has_position() is false.
std::string fault_of_position(const RowSearch& rows, const Pair& pair);

struct RowRange {
    std::uint32_t begin = 0, end = 0;
    std::uint32_t block = 256;  ///< number of rows that a thread takes at a time
};

/// The order in which a visit gets the columns of a row.
enum class Columns : std::uint8_t { ascending, any };

class RowPass {
public:
    /// `progress` may be empty; it receives the fraction of all rows that are visited, 0 to 1. Borrows all but the token.
    RowPass(const RowSearch& rows, Team& team, std::stop_token stop, const ProgressSink& progress);

    const RowSearch& rows() const { return rows_; }
    Team& team() const { return team_; }

    /// Checks one row: object `a` and the b of all its pairs. Called on several threads at once.
    using Visit = std::function<ResultFault(std::uint32_t a, std::span<const std::uint32_t> columns)>;
    /// Visits the rows of a range, each with its columns in the order `order`. Rows after a row with a fault may be skipped.
    /// Returns the fault of the lowest row. Throws: Error{cancelled}.
    ResultFault run(const RowRange& range, Columns order, const Visit& visit) const;

private:
    const RowSearch& rows_;
    Team& team_;
    std::stop_token stop_;
    const ProgressSink& progress_;
};

}  // namespace octopair
