// RandomStream: random numbers from integer arithmetic only. Each object has its own SplitMix64 stream.
//
// Source: Steele, Lea, Flood 2014, "Fast Splittable Pseudorandom Number Generators" (the mixer and the increment).
#pragma once

#include <cstdint>

namespace octopair::samples {

constexpr std::uint64_t mix_bits(std::uint64_t bits) {
    bits = (bits ^ (bits >> 30)) * 0xbf58476d1ce4e5b9u;
    bits = (bits ^ (bits >> 27)) * 0x94d049bb133111ebu;
    return bits ^ (bits >> 31);
}

class RandomStream {
public:
    /// Makes the stream of (seed, index). Different streams are statistically independent.
    constexpr RandomStream(std::uint64_t seed, std::uint64_t index)
        : state_(mix_bits(mix_bits(seed + increment) + index * increment)) {}

    constexpr std::uint64_t next() { return mix_bits(state_ += increment); }
    /// Returns a uniform number in [0, 1), a multiple of 2^-53.
    constexpr double uniform() { return double(next() >> 11) * 0x1p-53; }
    /// Returns a uniform number in [low, high).
    constexpr double uniform(double low, double high) { return low + (high - low) * uniform(); }
    /// Returns a uniform integer in [0, bound), with a bias below bound / 2^32. Requires: 0 < bound <= 2^32.
    constexpr std::uint64_t below(std::uint64_t bound) { return (next() >> 32) * bound >> 32; }
    /// Returns an approximately normal number of mean 0 and variance 1: the sum of twelve uniform numbers, minus 6.
    constexpr double gaussian() {
        double sum = -6;
        for (int i = 0; i < 12; ++i) sum += uniform();
        return sum;
    }

private:
    static constexpr std::uint64_t increment = 0x9e3779b97f4a7c15u;
    std::uint64_t state_;
};

}  // namespace octopair::samples
