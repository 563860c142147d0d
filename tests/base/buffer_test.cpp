// Tests Buffer and GrowingArray: sizes, contents and alignment.
#include <gtest/gtest.h>

#include <cstdint>
#include <numeric>

#include "base/growing_array.hpp"
#include "base/memory.hpp"

namespace octopair::test {
namespace {

TEST(Buffer, IsAlignedToALineOfTheCache) {
    for (const std::size_t size : {1u, 100u, 5000u, 3'000'000u}) {
        const Buffer<std::uint32_t> buffer(size);
        EXPECT_EQ(buffer.size(), size);
        EXPECT_EQ(reinterpret_cast<std::uintptr_t>(buffer.data()) % 64, 0u);
    }
}

TEST(Buffer, KeepsItsMemoryWhenItIsMadeSmaller) {
    Buffer<int> buffer(1000);
    std::iota(buffer.span().begin(), buffer.span().end(), 0);
    const int* const memory = buffer.data();
    buffer.resize_discard(10);
    EXPECT_EQ(buffer.size(), 10u);
    buffer.resize_discard(1000);
    EXPECT_EQ(buffer.data(), memory);
    EXPECT_EQ(buffer[999], 999);
    buffer.clear();
    EXPECT_EQ(buffer.size(), 0u);
}

TEST(Buffer, ReservedMemoryIsCommittedInParts) {
    Buffer<std::uint64_t> buffer;
    buffer.reserve_discard(1 << 20);
    buffer.commit(1000, 24);
    for (std::size_t i = 1000; i < 1024; ++i) buffer[i] = i;
    buffer.commit(1000, 24);  // a repeated commit keeps the contents
    for (std::size_t i = 1000; i < 1024; ++i) EXPECT_EQ(buffer[i], i);
}

TEST(Buffer, MovesWithItsMemory) {
    Buffer<int> first(3);
    first[2] = 7;
    const Buffer<int> second = std::move(first);
    EXPECT_EQ(second.size(), 3u);
    EXPECT_EQ(second[2], 7);
}

TEST(GrowingArray, HoldsWhatWasAdded) {
    GrowingArray<int> array;
    EXPECT_TRUE(array.empty());
    for (int i = 0; i < 10'000; ++i) array.push_back(i);
    ASSERT_EQ(array.size(), 10'000u);
    for (int i = 0; i < 10'000; ++i) ASSERT_EQ(array[std::size_t(i)], i);
    array.resize(10'002, -1);
    EXPECT_EQ(array[9'999], 9'999);
    EXPECT_EQ(array[10'001], -1);
    array.clear();
    EXPECT_TRUE(array.span().empty());
}

TEST(GrowingArray, AddsAnElementOfItsOwn) {
    GrowingArray<int> array;
    array.push_back(5);
    for (int i = 0; i < 100; ++i) array.push_back(array[0]);  // also when the elements move to larger memory
    for (const int element : array.span()) EXPECT_EQ(element, 5);
}

}  // namespace
}  // namespace octopair::test
