// Study as text: figure 5, tables 1 and 2, the components and the fits, next to the paper's own figures.
#pragma once

#include <string>

#include "paper/study.hpp"

namespace octopair::paper {

/// Formats 1234567 as "1,234,567".
std::string grouped(std::uint64_t number);
std::string microseconds(double seconds);

/// Comparison of a parallel run with the serial run of the same algorithm (the paper's section 5.2).
struct Speedup {
    double speedup;     ///< serial time / parallel time
    double efficiency;  ///< speedup / processors
};

struct TimedRun {
    double seconds;
    unsigned processors;
};

/// Requires: both times are above 0.
Speedup speedup_of(const TimedRun& run, double serial_seconds);

/// Returns the numbers of objects that have a table of speedups: the paper's numbers that were measured, else the
/// largest.
std::vector<std::uint64_t> table_objects(const Study& study);

/// Returns lines, each ended by a newline. Tables and components are in microseconds, like in the paper.
std::string study_text(const Study& study);

}  // namespace octopair::paper
