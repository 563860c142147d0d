// A study as text: figure 5, tables 1 and 2, the components, the fits; the paper's own figures beside.
#pragma once

#include <string>

#include "paper/study.hpp"

namespace octopair::paper {

/// 1234567 as "1,234,567".
std::string grouped(std::uint64_t number);
std::string microseconds(double seconds);

/// How a parallel run compares with the serial one of the same algorithm (the paper's section 5.2).
struct Speedup {
    double speedup;     ///< serial time / parallel time
    double efficiency;  ///< speedup / processors
};

struct TimedRun {
    double seconds;
    unsigned processors;
};

/// Both times are above 0.
Speedup speedup_of(const TimedRun& run, double serial_seconds);

/// The numbers of objects that get a table of speedups: the paper's, as far as they were measured; else the largest.
std::vector<std::uint64_t> table_objects(const Study& study);

/// Several lines, each ended. Times of tables and components are in microseconds, as in the paper.
std::string study_text(const Study& study);

}  // namespace octopair::paper
