#include "paper/fit.hpp"

#include <algorithm>
#include <cmath>

#include "machine/median.hpp"

namespace octopair::paper {

namespace {

double root_mean_square(std::span<const double> values) {
    double sum = 0;
    for (const double value : values) sum += value * value;
    return values.empty() ? 0 : std::sqrt(sum / double(values.size()));
}

/// Returns the `a` that minimises the sum of (a f(n) / t - 1)^2.
template <typename Function>
Fit fit_function(std::span<const Sample> samples, const Function& function) {
    std::vector<double> ratios;
    ratios.reserve(samples.size());
    for (const Sample& sample : samples) ratios.push_back(function(sample.objects) / sample.seconds);
    double sum = 0, squares = 0;
    for (const double ratio : ratios) {
        sum += ratio;
        squares += ratio * ratio;
    }
    const double a = squares > 0 ? sum / squares : 0;
    for (double& ratio : ratios) ratio = a * ratio - 1;
    return {a, root_mean_square(ratios)};
}

Growth growth_of(const Fits& fits) {
    if (std::abs(fits.linear.residual - fits.n_log_n.residual) <= fits.spread) return Growth::unclear;
    return fits.linear.residual < fits.n_log_n.residual ? Growth::linear : Growth::n_log_n;
}

}  // namespace

double relative_spread(const std::vector<double>& values) {
    const double middle = bench::median(values);
    if (middle == 0) return 0;
    std::vector<double> distances = values;
    for (double& value : distances) value = std::abs(value - middle);
    return bench::median(distances) / middle;
}

Fits fit(std::span<const Sample> samples) {
    Fits fits;
    if (samples.empty()) return fits;
    fits.linear = fit_function(samples, [](double n) { return n; });
    fits.n_log_n = fit_function(samples, [](double n) { return n * std::log2(n); });
    std::vector<double> spreads;
    spreads.reserve(samples.size());
    for (const Sample& sample : samples) spreads.push_back(sample.spread);
    fits.spread = root_mean_square(spreads);
    if (samples.size() > 1) fits.growth = growth_of(fits);
    return fits;
}

std::string_view growth_text(Growth growth) {
    switch (growth) {
        case Growth::linear:
            return "a n";
        case Growth::n_log_n:
            return "a n log2 n";
        case Growth::unclear:
            break;
    }
    return "cannot tell";
}

}  // namespace octopair::paper
