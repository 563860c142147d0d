// Tests the bounds on free memory, on copies of the system's files, and texts with amounts.
#include "base/free_memory.hpp"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include "io/temporary.hpp"

namespace octopair::test {
namespace {

class FreeMemoryFiles : public ::testing::Test {
protected:
    void write(const std::string& path, const std::string& text) const {
        const std::filesystem::path file = root_.path() + path;
        std::filesystem::create_directories(file.parent_path());
        std::ofstream(file) << text;
    }
    void write_machine() const {
        write("/proc/meminfo",
              "MemTotal:  9000000 kB\nMemFree:  100 kB\nMemAvailable:  8000000 kB\nSwapFree:  1000 kB\n");
    }
    std::uint64_t free() const { return free_memory(root_.path()).value_or(0); }

    static constexpr std::uint64_t machine = 8'001'000ull * 1024;
    TemporaryDirectory root_;
};

TEST_F(FreeMemoryFiles, IsUnknownWithoutFiles) {
    EXPECT_FALSE(free_memory(root_.path()));
    write("/proc/meminfo", "MemTotal:  9000000 kB\nMemAvailable: many\n");
    EXPECT_FALSE(free_memory(root_.path()));
}

TEST_F(FreeMemoryFiles, OfTheMachineIncludesSwap) {
    write_machine();
    EXPECT_EQ(free(), machine);
}

TEST_F(FreeMemoryFiles, OfAControlGroupOfVersion2) {
    write_machine();
    write("/proc/self/cgroup", "0::/service/unit\n");
    const std::string group = "/sys/fs/cgroup/service";
    write(group + "/unit/memory.max", "max\n");
    write(group + "/unit/memory.current", "300000000\n");
    EXPECT_EQ(free(), machine);
    write(group + "/memory.max", "500000000\n");
    EXPECT_EQ(free(), machine) << "the used memory is unknown";
    write(group + "/memory.current", "400000000\n");
    EXPECT_EQ(free(), 100'000'000u + 1'024'000);
    write(group + "/memory.stat", "anon 7\nfile 90\ninactive_file 30\nactive_file 5\nslab_reclaimable 1\n");
    EXPECT_EQ(free(), 100'000'036u + 1'024'000);
    write(group + "/memory.swap.current", "600\n");
    write(group + "/memory.swap.max", "max\n");
    EXPECT_EQ(free(), 100'000'036u + 1'024'000);
    write(group + "/memory.swap.max", "1000\n");
    EXPECT_EQ(free(), 100'000'036u + 400);
    write(group + "/memory.current", "600000000\n");
    EXPECT_EQ(free(), 0u);
}

TEST_F(FreeMemoryFiles, OfAControlGroupOfVersion1) {
    write_machine();
    write("/proc/self/cgroup", "4:memory:/docker/1f\n3:cpuset:/\n0::/\n");
    const std::string group = "/sys/fs/cgroup/memory";
    write(group + "/memory.limit_in_bytes", "9223372036854771712\n");
    write(group + "/memory.usage_in_bytes", "300\n");
    EXPECT_EQ(free(), machine);
    write(group + "/memory.limit_in_bytes", "1000000\n");
    write(group + "/memory.stat", "inactive_file 1\ntotal_inactive_file 30\ntotal_active_file 5\n");
    EXPECT_EQ(free(), 1'000'000u - 300 + 35 + 1'024'000);
    write(group + "/memory.memsw.limit_in_bytes", "1000100\n");
    write(group + "/memory.memsw.usage_in_bytes", "400\n");
    EXPECT_EQ(free(), 1'000'100u - 400 + 35);
}

TEST(FreeMemory, IsKnownHere) { EXPECT_GT(free_memory().value_or(0), 1'000'000u); }

TEST(Amounts, HaveGroupsOfDigits) {
    EXPECT_EQ(digit_groups(0), "0");
    EXPECT_EQ(digit_groups(999), "999");
    EXPECT_EQ(digit_groups(1000), "1,000");
    EXPECT_EQ(digit_groups(19'999'900'000), "19,999,900,000");
}

TEST(Amounts, HaveThreeDigitsAndAUnit) {
    EXPECT_EQ(byte_text(0), "0 bytes");
    EXPECT_EQ(byte_text(999), "999 bytes");
    EXPECT_EQ(byte_text(1000), "1.00 KB");
    EXPECT_EQ(byte_text(9'994'999), "9.99 MB");
    EXPECT_EQ(byte_text(9'996'000), "10.0 MB");
    EXPECT_EQ(byte_text(99'960'000'000), "100 GB");
    EXPECT_EQ(byte_text(159'999'200'000), "160 GB");
    EXPECT_EQ(byte_text(999'600'000'000), "1.00 TB");
    EXPECT_EQ(byte_text(~0ull), "18.4 EB");
}

}  // namespace
}  // namespace octopair::test
