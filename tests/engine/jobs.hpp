// Helpers for the tests of jobs.
#pragma once

#include <gtest/gtest.h>

#include <semaphore>
#include <vector>

#include "octopair/octopair.hpp"
#include "support/calls.hpp"
#include "support/errors.hpp"

namespace octopair::test {

/// Two boxes that touch: one pair, one batch.
inline const std::vector<Box3f> touching_boxes = {{{0, 0, 0}, {1, 1, 1}}, {{1, 1, 1}, {2, 2, 2}}};

/// A job that runs until the test releases it. Its sink ignores stop requests.
class HeldJob {
public:
    /// Returns when the job runs.
    explicit HeldJob(Engine& engine)
        : job_(engine.submit_stream(touching_boxes, [this](std::span<const Pair>) {
              entered_.release();
              go_on_.acquire();
          })) {
        entered_.acquire();
    }
    HeldJob(const HeldJob&) = delete;
    HeldJob& operator=(const HeldJob&) = delete;
    ~HeldJob() { let_go_on(); }

    void let_go_on() { go_on_.release(); }
    Job& job() { return job_; }

private:
    std::counting_semaphore<> entered_{0}, go_on_{0};
    Job job_;
};

}  // namespace octopair::test
