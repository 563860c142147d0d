// How time grows with the number of objects: least squares of t = a n and of t = a n log2 n.
//
// Residuals are relative to the measured time, so that small scenes count as much as large ones.
#pragma once

#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

namespace octopair::paper {

/// The middle one; of an even number, the upper of the two in the middle. 0 of none.
double median(std::vector<double> values);
/// The median distance from the median, as a part of it.
double relative_spread(const std::vector<double>& values);

/// One point of a curve; objects >= 2, seconds > 0.
struct Sample {
    double objects;
    double seconds;
    double spread;  ///< relative, of the runs behind it
};

struct Fit {
    double a = 0;         ///< seconds
    double residual = 0;  ///< root mean square, relative
};

enum class Growth : std::uint8_t { linear, n_log_n, unclear };

struct Fits {
    Fit linear;
    Fit n_log_n;
    double spread = 0;                ///< root mean square of the samples'
    Growth growth = Growth::unclear;  ///< the smaller residual, unless they differ by less than the spread
};

/// Of one sample or none the growth is unclear.
Fits fit(std::span<const Sample> samples);

/// "a n", "a n log2 n", "cannot tell".
std::string_view growth_text(Growth growth);

}  // namespace octopair::paper
