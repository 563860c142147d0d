// Descriptor: owns an open file descriptor and closes it.
#pragma once

#include <unistd.h>

#include <utility>

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

}  // namespace octopair
