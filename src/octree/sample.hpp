// Sample: one position of each stride, at a fixed scattered place in it.
#pragma once

#include <cstddef>
#include <cstdint>

namespace octopair {

/// The positions of [0, size) that stand for all, in ascending order. Scattered, so that what is laid out with a period
/// does not fool the sample; fixed, so that it is a function of the size alone.
class Sample {
public:
    /// About one position of each `stride`, but at most about `most`. Requires: `stride` and `most` are 1 or more.
    Sample(std::size_t size, std::size_t stride, std::size_t most) : size_(size) {
        stride_ = stride > size / most ? stride : size / most;
    }

    std::size_t size() const { return (size_ + stride_ - 1) / stride_; }
    std::size_t operator[](std::size_t i) const {
        const std::uint64_t scattered = (std::uint64_t(i) * 0x9E3779B97F4A7C15ull) >> 32;
        const std::size_t position = i * stride_ + std::size_t(scattered * stride_ >> 32);
        return position < size_ ? position : size_ - 1;
    }
    /// How many positions each of the sample stands for.
    std::size_t stride() const { return stride_; }

private:
    std::size_t size_;
    std::size_t stride_;
};

}  // namespace octopair
