// Tests ScanMemoryPool: who gets which memory.
#include "octree/scan/scan.hpp"

#include <gtest/gtest.h>

namespace octopair::test {
namespace {

TEST(ScanMemoryPool, LendsEachMemoryToOneUserAtATime) {
    ScanMemoryPool pool;
    const ScanMemoryPool::Lent first = pool.lend(), second = pool.lend();
    EXPECT_NE(first.get(), second.get());
}

TEST(ScanMemoryPool, LendsReturnedMemoryAgain) {
    ScanMemoryPool pool;
    ScanMemoryPool::Lent lent = pool.lend();
    const ScanMemory* const memory = lent.get();
    lent.reset();
    EXPECT_EQ(pool.lend().get(), memory);
}

}  // namespace
}  // namespace octopair::test
