// Tests the limits of control groups, on copies of the system's files.
#include "base/control_group.hpp"

#include <gtest/gtest.h>
#include <sched.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <thread>

#include "io/temporary.hpp"

namespace octopair::test {
namespace {

class ControlGroup : public ::testing::Test {
protected:
    void write(const std::string& path, const std::string& text) const {
        const std::filesystem::path file = root_.path() + path;
        std::filesystem::create_directories(file.parent_path());
        std::ofstream(file) << text;
    }
    ControlGroupLimits limits() const { return control_group_limits(root_.path()); }

    TemporaryDirectory root_;
};

TEST_F(ControlGroup, HasNoLimitWithoutFiles) {
    EXPECT_FALSE(limits().memory_bytes);
    EXPECT_FALSE(limits().cores);
    write("/proc/self/cgroup", "0::/a\n\nnonsense\n1:x\n");
    write("/sys/fs/cgroup/a/memory.max", "max\n");
    write("/sys/fs/cgroup/a/cpu.max", "max 100000\n");
    EXPECT_FALSE(limits().memory_bytes);
    EXPECT_FALSE(limits().cores);
}

TEST_F(ControlGroup, OfVersion2HasTheStrictestLimitOfItsParents) {
    write("/proc/self/cgroup", "0::/service/unit\n");
    write("/sys/fs/cgroup/memory.max", "9000000000\n");
    write("/sys/fs/cgroup/service/memory.max", "5000000000\n");
    write("/sys/fs/cgroup/service/unit/memory.max", "max\n");
    write("/sys/fs/cgroup/service/unit/cpu.max", "250000 100000\n");
    write("/sys/fs/cgroup/service/cpu.max", "400000 100000\n");
    EXPECT_EQ(limits().memory_bytes.value_or(0), 5'000'000'000u);
    EXPECT_EQ(limits().cores.value_or(0), 2.5);
}

TEST_F(ControlGroup, OfVersion1HasAFolderForEachController) {
    write("/proc/self/cgroup", "4:memory:/docker/1f\n3:cpuset:/\n2:cpu,cpuacct:/docker/1f\n1:name=systemd:/\n0::/\n");
    // In a container, the group's own folder is the mount.
    write("/sys/fs/cgroup/memory/memory.limit_in_bytes", "2147483648\n");
    write("/sys/fs/cgroup/cpu,cpuacct/cpu.cfs_quota_us", "50000\n");
    write("/sys/fs/cgroup/cpu,cpuacct/cpu.cfs_period_us", "100000\n");
    EXPECT_EQ(limits().memory_bytes.value_or(0), 2'147'483'648u);
    EXPECT_EQ(limits().cores.value_or(0), 0.5);
    write("/sys/fs/cgroup/memory/memory.limit_in_bytes", "9223372036854771712\n");
    write("/sys/fs/cgroup/cpu,cpuacct/cpu.cfs_quota_us", "-1\n");
    EXPECT_FALSE(limits().memory_bytes);
    EXPECT_FALSE(limits().cores);
}

/// Restricts the process to one of its processors, as taskset does.
class OneProcessor {
public:
    OneProcessor() {
        EXPECT_EQ(::sched_getaffinity(::getpid(), sizeof before_, &before_), 0);
        cpu_set_t one;
        CPU_ZERO(&one);
        for (int i = 0; CPU_COUNT(&one) == 0 && i < CPU_SETSIZE; ++i) {
            if (CPU_ISSET(i, &before_)) CPU_SET(i, &one);
        }
        EXPECT_EQ(::sched_setaffinity(::getpid(), sizeof one, &one), 0);
    }
    ~OneProcessor() { EXPECT_EQ(::sched_setaffinity(::getpid(), sizeof before_, &before_), 0); }
    OneProcessor(const OneProcessor&) = delete;
    OneProcessor& operator=(const OneProcessor&) = delete;

private:
    cpu_set_t before_ = {};
};

TEST(AvailableCores, AreThoseThatTheProcessMayUse) {
    const unsigned before = allowed_processors();
    {
        const OneProcessor one;
        EXPECT_EQ(allowed_processors(), 1u);
        EXPECT_EQ(available_cores(), 1u);
    }
    EXPECT_EQ(allowed_processors(), before);
}

TEST(AvailableCores, AreThoseOfTheMachineOrFewer) {
    EXPECT_GE(available_cores(), 1u);
    EXPECT_LE(available_cores(), std::max(1u, std::thread::hardware_concurrency()));
}

}  // namespace
}  // namespace octopair::test
