// A hash of pairs and boxes: FNV-1a over 32-bit words. The hash depends on the bytes and on their order.
#pragma once

#include <bit>
#include <cstdint>
#include <span>

#include "octopair/objects.hpp"

namespace octopair::test {

class Hash {
public:
    void add(std::uint32_t word) { value_ = (value_ ^ word) * 0x100000001b3u; }
    void add(std::span<const Pair> pairs) {
        for (const Pair pair : pairs) {
            add(pair.a);
            add(pair.b);
        }
    }
    void add(std::span<const Box3f> boxes) {
        for (const Box3f& box : boxes) {
            for (const float x : box.min) add(std::bit_cast<std::uint32_t>(x));
            for (const float x : box.max) add(std::bit_cast<std::uint32_t>(x));
        }
    }
    std::uint64_t value() const { return value_; }

private:
    std::uint64_t value_ = 0xcbf29ce484222325u;
};

template <typename Items>
std::uint64_t hash_of(const Items& items) {
    Hash hash;
    hash.add(std::span(items));
    return hash.value();
}

}  // namespace octopair::test
