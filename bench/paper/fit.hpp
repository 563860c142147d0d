// Growth of time with the number of objects: least squares fits of t = a n and of t = a n log2 n.
//
// Residuals are relative to the measured time, so that small scenes count as much as large ones.
#pragma once

#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

namespace octopair::paper {

/// Returns the median distance from the median, relative to the median.
double relative_spread(const std::vector<double>& values);

/// One point of a curve; objects >= 2, seconds > 0.
struct Sample {
    double objects;
    double seconds;
    double spread;  ///< relative spread of the runs of this point
};

struct Fit {
    double a = 0;         ///< seconds
    double residual = 0;  ///< root mean square, relative
};

enum class Growth : std::uint8_t { linear, n_log_n, unclear };

struct Fits {
    Fit linear;
    Fit n_log_n;
    double spread = 0;                ///< root mean square of the samples' spreads
    Growth growth = Growth::unclear;  ///< fit with smaller residual; unclear if both differ by at most the spread
};

/// Fits both curves. With fewer than two samples the growth is unclear.
Fits fit(std::span<const Sample> samples);

/// Returns "a n", "a n log2 n" or "cannot tell".
std::string_view growth_text(Growth growth);

}  // namespace octopair::paper
