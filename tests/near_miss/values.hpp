// Values: what a parser read, as one line of words that near_miss_test.py compares with an independent reading.
//
//   d<16 hex digits>   a float64, as its bits; -0 is written as 0
//   ~<16 hex digits>   a float64 that was computed; rounding may differ
//   t<hex digits>      bytes of a text
//   other words        whole numbers, and names of kinds
#pragma once

#include <fmt/format.h>

#include <bit>
#include <cstdint>
#include <string>
#include <string_view>

namespace octopair::test {

class Values {
public:
    void number(double value) { line_ += fmt::format(" d{:016x}", std::bit_cast<std::uint64_t>(value + 0.0)); }
    void computed(double value) { line_ += fmt::format(" ~{:016x}", std::bit_cast<std::uint64_t>(value + 0.0)); }
    void text(std::string_view bytes) {
        line_ += " t";
        for (const char c : bytes) line_ += fmt::format("{:02x}", unsigned(std::uint8_t(c)));
    }
    template <typename Whole>
    void whole(Whole value) {
        line_ += fmt::format(" {}", value);
    }
    void word(std::string_view name) { line_ += fmt::format(" {}", name); }

    const std::string& line() const { return line_; }

private:
    std::string line_;
};

}  // namespace octopair::test
