// Conversions that all modules share: traits of objects, summaries, states of jobs, and progress functions.
#include <algorithm>
#include <array>

#include "bindings.hpp"
#include "engines.hpp"
#include "scenes.hpp"

namespace octopair::python {

std::vector<Traits> traits_of(const py::object& groups, const py::object& masks, const py::object& fixed) {
    const auto group_column = optional_rows_of<std::uint32_t>(groups);
    const auto mask_column = optional_rows_of<std::uint32_t>(masks);
    const auto fixed_column = optional_rows_of<bool>(fixed);
    const std::size_t size = std::max({group_column.size(), mask_column.size(), fixed_column.size()});
    std::vector<Traits> traits(size);
    for (std::size_t i = 0; i < size; ++i) {
        if (!group_column.empty()) traits[i].groups = group_column[i];
        if (!mask_column.empty()) traits[i].mask = mask_column[i];
        if (!fixed_column.empty()) traits[i].fixed = fixed_column[i];
    }
    return traits;
}

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
