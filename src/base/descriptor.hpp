// Descriptor: owns an open file descriptor and closes it. fail_io() turns a failed system call on a file into an Error.
#pragma once

#include <unistd.h>

#include <string_view>
#include <utility>

#include "base/private_export.hpp"

namespace octopair {

class Descriptor {
public:
    Descriptor() = default;
    explicit Descriptor(int number) : number_(number) {}
    Descriptor(Descriptor&& other) noexcept : number_(std::exchange(other.number_, -1)) {}
    Descriptor& operator=(Descriptor&& other) noexcept {
        std::swap(number_, other.number_);
        return *this;
    }
    ~Descriptor() {
        if (number_ >= 0) ::close(number_);
    }

    int number() const { return number_; }
    bool open() const { return number_ >= 0; }
    /// Returns the number and gives up ownership: the caller must close it.
    int release() { return std::exchange(number_, -1); }
    /// Closes the file now. Returns the result of close(): some file systems report a failed write only there.
    int close() { return ::close(std::exchange(number_, -1)); }

private:
    int number_ = -1;
};

/// Throws: Error{io_failed} "FILE: ACTION: REASON", where REASON is the system's text for `error_number`;
/// Error{resource_limit} if `error_number` means that memory or descriptors ran out.
OCTOPAIR_PRIVATE_EXPORT [[noreturn]] void fail_io(std::string_view file, std::string_view action, int error_number);

}  // namespace octopair
