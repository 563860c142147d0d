// Tests worker processes on small scenes with tiny tuning against brute force, and on large scenes against the second
// algorithm. Workers read the tuning from memory that they share with this process, and count paths there.
#include <gtest/gtest.h>
#include <sys/mman.h>
#include <unistd.h>

#include <cstdlib>
#include <memory>
#include <string>

#include "exactness/large_scenes.hpp"
#include "exactness/small_scenes.hpp"
#include "octopair/processes.hpp"
#include "support/families.hpp"
#include "support/scale.hpp"

namespace octopair::test {
namespace {

/// Makes named memory for the hooks before their first use. Workers share it during the life of this process.
const int shared_hooks = [] {
    const int file = ::memfd_create("octopair test hooks", MFD_CLOEXEC);
    const std::string name = "/proc/" + std::to_string(::getpid()) + "/fd/" + std::to_string(file);
    ::setenv("OCTOPAIR_TEST_HOOKS_FILE", name.c_str(), 1);
    return file;
}();

/// Returns a local engine for 1 thread, otherwise an engine with as many worker processes. So tests compare the octal
/// order of both engines.
EngineFor workers() {
    std::shared_ptr<Engine> local = make_local_engine(2);
    std::shared_ptr<Engine> two = make_process_engine(2);
    std::shared_ptr<Engine> three = make_process_engine(3);
    return [=](unsigned threads) -> Engine& { return threads == 1 ? *local : threads == 2 ? *two : *three; };
}

TEST(LargeScenesOnWorkers, GiveEachPairOnce) {
    const EngineFor engines = workers();
    Case long_tails;
    long_tails.first.boxes = long_tailed_boxes(scaled(40'000, 4), 2);
    for (Case a_case : {long_tails, cloth_case(scaled(120'000, 8), 1)}) {
        a_case.threads[0] = 2, a_case.threads[1] = 3;
        const auto finding = check_large_case(a_case, engines, Calls::few);
        ASSERT_FALSE(finding) << finding->check << ": " << finding->text;
    }
}

#ifdef OCTOPAIR_TEST_HOOKS

constexpr std::uint64_t usual = scaled(300, 10);

class SmallScenesOnWorkers : public ::testing::Test {
protected:
    /// Returns fewer scenes than the tests of a single process, by a constant factor.
    static SceneRange seeds(std::uint64_t scenes) {
        const SceneRange all = scene_range(SceneSize::small, 10'000);
        return all.size() == 1 ? all : all.part(0, 10'000 / scenes);
    }
    static void check(std::uint64_t scenes, const EngineFor& engines) {
        ASSERT_GE(shared_hooks, 0);
        const auto finding = check_small_cases(seeds(scenes), engines);
        ASSERT_FALSE(finding) << finding->check << ": " << finding->text;
    }
};

TEST_F(SmallScenesOnWorkers, AreWhatBruteForceFinds) {
    check(usual, workers());
    if (sanitized || seeds(usual).size() < usual) return;
    using enum Path;
    EXPECT_EQ(paths_not_taken({nested_once, nested_shared, large_octant, buffer_over, window, region_kept,
                               region_copied, ring_wrapped, bucket_sorted, bucket_split}),
              "");
}

#endif

}  // namespace
}  // namespace octopair::test
