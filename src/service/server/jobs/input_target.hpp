// InputTarget: where the input of a job goes, piece by piece.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

namespace octopair::service {

class InputTarget {
public:
    virtual ~InputTarget() = default;
    /// Throws Error{bad_input} for more than the job has.
    virtual void append(std::span<const std::byte> data) = 0;
    /// Bytes that have not come yet.
    virtual std::uint64_t missing() const = 0;
};

/// Throws Error{bad_input} if `data` is more than what is missing.
void check_fits(std::span<const std::byte> data, std::uint64_t missing);

}  // namespace octopair::service
