// UnitChange: converts lengths from one unit to another.
#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace octopair::io {

/// Returns the unit that measures this many metres, for example "mm" for 0.001; empty if none is known.
std::string unit_of_metres(double metres);

/// Returns the length of a unit in metres, for example 0.001 for "mm"; nothing if the unit is not known.
std::optional<double> metres_of(std::string_view unit);

class UnitChange {
public:
    /// Makes a change that keeps all lengths.
    UnitChange() = default;
    /// Keeps all lengths if a unit is empty or not known, or if both units are equal.
    UnitChange(std::string_view from, std::string_view to);

    bool is_none() const { return factor_ == 1; }
    /// Returns a length in the new unit. Between units of the metric system, only the decimal point moves: the result is the float64 that is
    /// nearest to the shifted decimal number. So 2.047 m are exactly 2047 mm, as in a file in millimetres. Otherwise, the result is one product.
    double operator()(double length) const;
    /// Returns the factor of the change, rounded to float64.
    double factor() const { return factor_; }

private:
    double factor_ = 1;
    int decimals_ = 0;  // number of places by which the decimal point moves to the right; 0: no power of ten
};

}  // namespace octopair::io
