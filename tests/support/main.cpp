// The main() of test programs. Records the processor seconds of each test, and of the start of the program, in the results that
// --gtest_output writes; tools/test_results.py reads them.
#include <gtest/gtest.h>
#include <sys/resource.h>

#include <string>

namespace {

double seconds(const timeval& time) { return double(time.tv_sec) + 1e-6 * double(time.tv_usec); }

/// Returns the processor seconds of this process, and of its children that have ended and were waited for.
double processor_seconds() {
    double sum = 0;
    for (const auto who : {RUSAGE_SELF, RUSAGE_CHILDREN}) {
        rusage usage{};
        ::getrusage(who, &usage);
        sum += seconds(usage.ru_utime) + seconds(usage.ru_stime);
    }
    return sum;
}

class ProcessorTime : public testing::EmptyTestEventListener {
    void OnTestProgramStart(const testing::UnitTest&) override { record(processor_seconds()); }
    void OnTestStart(const testing::TestInfo&) override { begin_ = processor_seconds(); }
    void OnTestEnd(const testing::TestInfo&) override { record(processor_seconds() - begin_); }

    static void record(double value) { testing::Test::RecordProperty("processor_seconds", std::to_string(value)); }

    double begin_ = 0;
};

}  // namespace

int main(int argc, char** argv) {
    testing::InitGoogleTest(&argc, argv);
    testing::UnitTest::GetInstance()->listeners().Append(new ProcessorTime);
    return RUN_ALL_TESTS();
}
