// InputTarget: receives the input of a job, piece by piece.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

namespace octopair::service {

class InputTarget {
public:
    virtual ~InputTarget() = default;
    /// Throws: Error{bad_input} if `data` is longer than missing().
    virtual void append(std::span<const std::byte> data) = 0;
    /// Returns the number of bytes that were not appended yet.
    virtual std::uint64_t missing() const = 0;
};

/// Throws: Error{bad_input} if `data` has more than `missing` bytes.
void check_fits(std::span<const std::byte> data, std::uint64_t missing);

}  // namespace octopair::service
