// Sample: one position of each stride of a range, at a fixed pseudorandom place within the stride.
#pragma once

#include <cstddef>
#include <cstdint>

namespace octopair {

/// Sampled positions of [0, size), ascending. Places are scattered, so that a period in the data does not bias the sample.
/// They are fixed, so that the sample is a function of the constructor's arguments alone.
class Sample {
public:
    /// Samples about one position of each `stride`, but at most about `most` positions.
    /// Requires: `stride` and `most` are 1 or more.
    Sample(std::size_t size, std::size_t stride, std::size_t most) : size_(size) {
        stride_ = stride > size / most ? stride : size / most;
    }

    std::size_t size() const { return (size_ + stride_ - 1) / stride_; }
    std::size_t operator[](std::size_t i) const {
        const std::uint64_t scattered = (std::uint64_t(i) * 0x9E3779B97F4A7C15ull) >> 32;
        const std::size_t position = i * stride_ + std::size_t(scattered * stride_ >> 32);
        return position < size_ ? position : size_ - 1;
    }
    /// Returns the number of positions that each sampled position represents.
    std::size_t stride() const { return stride_; }

private:
    std::size_t size_;
    std::size_t stride_;
};

}  // namespace octopair
