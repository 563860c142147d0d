#include "io/formats/unit_change.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <utility>

namespace octopair::io {

namespace {

/// Units and their lengths in micrometres.
constexpr std::array<std::pair<std::string_view, std::int64_t>, 8> units = {{{"µm", 1},
                                                                             {"mm", 1'000},
                                                                             {"cm", 10'000},
                                                                             {"dm", 100'000},
                                                                             {"m", 1'000'000},
                                                                             {"km", 1'000'000'000},
                                                                             {"in", 25'400},
                                                                             {"ft", 304'800}}};

std::int64_t micrometres(std::string_view unit) {
    const auto* const known =
        std::find_if(units.begin(), units.end(), [&](const auto& any) { return any.first == unit; });
    return known == units.end() ? 0 : known->second;
}

}  // namespace

std::string unit_of_metres(double metres) {
    for (const auto& [unit, length] : units) {
        if (metres == double(length) / 1e6) return std::string(unit);
    }
    return {};
}

std::optional<double> metres_of(std::string_view unit) {
    const std::int64_t length = micrometres(unit);
    return length == 0 ? std::nullopt : std::optional(double(length) / 1e6);
}

UnitChange::UnitChange(std::string_view from, std::string_view to) {
    const std::int64_t old_unit = micrometres(from), new_unit = micrometres(to);
    if (old_unit == 0 || new_unit == 0) return;
    factor_ = double(old_unit) / double(new_unit);
    const std::int64_t large = std::max(old_unit, new_unit), small = std::min(old_unit, new_unit);
    std::int64_t power = 1;
    int places = 0;
    for (; power * small < large; power *= 10) ++places;
    if (power * small == large) decimals_ = old_unit > new_unit ? places : -places;
}

double UnitChange::operator()(double length) const {
    const double product = length * factor_;
    if (decimals_ == 0 || !std::isfinite(length)) return product;
    std::array<char, 40> text;
    const auto [end, error] = std::to_chars(text.begin(), text.end(), length, std::chars_format::scientific);
    char* const exponent = std::find(text.begin(), end, 'e') + 1;
    int value = 0;
    (void)std::from_chars(exponent + (*exponent == '+' ? 1 : 0), end, value);
    const char* const new_end = std::to_chars(exponent, text.end(), value + decimals_).ptr;
    double shifted = product;  // stays if the result is beyond the range of float64
    (void)std::from_chars(text.begin(), new_end, shifted);
    return shifted;
}

}  // namespace octopair::io
