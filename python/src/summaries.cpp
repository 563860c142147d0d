// Conversions that all modules share: summaries, states of jobs, and progress functions.
#include <array>

#include "bindings.hpp"
#include "engines.hpp"

namespace octopair::python {

py::tuple summary_tuple(const Summary& summary) {
    const StepSeconds& steps = summary.steps;
    return py::make_tuple(summary.pairs, summary.truncated, summary.seconds, summary.entries,
                          py::make_tuple(steps.encode, steps.count, steps.scatter, steps.scan),
                          summary.verification.done, summary.verification.seconds, summary.verification.not_checked);
}

const char* state_name(JobState state) {
    constexpr std::array names = {"queued", "running", "done", "failed", "cancelled"};
    return names[std::size_t(state)];
}

Options with_progress(Options options, const py::object& progress, ProgressValue& value) {
    if (!progress.is_none()) options.progress = [&value](double fraction) { value.set(fraction); };
    return options;
}

}  // namespace octopair::python
