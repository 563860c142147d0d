// Main program of the tests of the MPI engine. Every rank runs all tests. Rank 0 prints all results, other ranks print
// failures only.
#include <gtest/gtest.h>

#include <cstdio>
#include <memory>

#include "exactness/small_scenes.hpp"
#include "mpi/ranks.hpp"

namespace octopair::test {
namespace {

class Failures final : public ::testing::EmptyTestEventListener {
    void OnTestPartResult(const ::testing::TestPartResult& result) override {
        if (!result.failed()) return;
        std::printf("rank %u: %s:%d: %s\n", own_rank(), result.file_name(), result.line_number(), result.summary());
        std::fflush(stdout);
    }
};

int run(int argc, char** argv) {
#ifdef OCTOPAIR_TEST_HOOKS
    if (own_rank() == 0) reset_test_hooks();  // creates the file of the hooks
    (void)on_all(true);
#endif
    ::testing::InitGoogleTest(&argc, argv);
    if (own_rank() != 0) {
        ::testing::TestEventListeners& listeners = ::testing::UnitTest::GetInstance()->listeners();
        delete listeners.Release(listeners.default_result_printer());
        listeners.Append(std::make_unique<Failures>().release());
    }
    return on_all(RUN_ALL_TESTS() == 0) ? 0 : 1;
}

}  // namespace
}  // namespace octopair::test

int main(int argc, char** argv) {
    int level = 0;
    MPI_Init_thread(&argc, &argv, MPI_THREAD_MULTIPLE, &level);
    const int status = octopair::test::run(argc, argv);
    MPI_Finalize();
    return status;
}
