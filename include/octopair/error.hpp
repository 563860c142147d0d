// Error: the one exception type that octopair throws.
//
// - Every failure of a public call throws an `Error`.
// - Its code is the kind of failure. Its message, one line, says what is wrong and where (file, object, value).
// - An error about one object, query or id also has its index (Error::place()).
// - Public calls turn std::bad_alloc into Error{resource_limit}, unless their header says otherwise.
#pragma once

#include <cstdint>
#include <optional>
#include <stdexcept>
#include <string>

namespace [[gnu::visibility("default")]] octopair {

enum class ErrorCode : std::uint8_t {
    usage,           ///< options contradict each other, or the call is not supported here
    bad_input,       ///< a box, file or option value is invalid
    io_failed,       ///< the operating system failed to read or write
    resource_limit,  ///< memory or another bounded resource ran out
    engine_failed,   ///< an engine failed, or its result is wrong
    cancelled,       ///< the caller requested a stop
};

/// The object, query or id of a call that an error is about.
struct ErrorPlace {
    /// Index of the object, query, id or triangle in its set. The message of the error has the same index.
    std::uint64_t index = 0;
    unsigned set = 0;                         ///< 1: the second set of a join; otherwise 0
    std::optional<std::uint64_t> frame = {};  ///< frame of a moving scene; absent if the input has no frames
};

class Error : public std::runtime_error {
public:
    Error(ErrorCode code, const std::string& message) : std::runtime_error(message), code_(code) {}
    ErrorCode code() const noexcept { return code_; }
    /// Returns the object, query or id that the error is about; nothing if the error is about none or several. A copy of an Error has
    /// no place. To keep the place, store a std::exception_ptr.
    std::optional<ErrorPlace> place() const noexcept;

private:
    ErrorCode code_;
};

/// An Error about one object, query or id. To handle errors, catch Error.
class PlacedError : public Error {
public:
    PlacedError(ErrorCode code, const std::string& message, const ErrorPlace& place)
        : Error(code, message), place_(place) {}
    const ErrorPlace& where() const noexcept { return place_; }

private:
    ErrorPlace place_;
};

/// An Error{resource_limit}: the pairs of a call need more than the free memory, or are more than stream_at_most() may pass.
class TooManyPairs : public Error {
public:
    TooManyPairs(const std::string& message, std::uint64_t pairs, bool exact)
        : Error(ErrorCode::resource_limit, message), pairs_(pairs), exact_(exact) {}
    /// Returns the number of pairs that the call would return (at most `Options::limit`). If exact() is false, the number is a lower bound.
    std::uint64_t pairs() const noexcept { return pairs_; }
    bool exact() const noexcept { return exact_; }

private:
    std::uint64_t pairs_;
    bool exact_;
};

inline std::optional<ErrorPlace> Error::place() const noexcept {
    const auto* placed = dynamic_cast<const PlacedError*>(this);
    return placed == nullptr ? std::nullopt : std::optional(placed->where());
}

}  // namespace octopair
