// Random numbers that depend on nothing but integers: a SplitMix64 stream of its own for every object.
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
    /// Streams of different (seed, index) have nothing to do with each other.
    constexpr RandomStream(std::uint64_t seed, std::uint64_t index)
        : state_(mix_bits(mix_bits(seed + increment) + index * increment)) {}

    constexpr std::uint64_t next() { return mix_bits(state_ += increment); }
    /// Uniform in [0, 1), a multiple of 2^-53.
    constexpr double uniform() { return double(next() >> 11) * 0x1p-53; }
    /// Uniform in [low, high).
    constexpr double uniform(double low, double high) { return low + (high - low) * uniform(); }
    /// Uniform in [0, bound), 0 < bound <= 2^32; off by less than bound / 2^32.
    constexpr std::uint64_t below(std::uint64_t bound) { return (next() >> 32) * bound >> 32; }
    /// Close to a normal variable of mean 0 and variance 1: the sum of twelve uniform ones, less 6.
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
