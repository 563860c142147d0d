// RowBins: neighbouring objects, by whom pairs are counted and shared out as their `a`.
#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <span>

#include "base/tuning.hpp"
#include "octopair/objects.hpp"

namespace octopair {

class RowBins {
public:
    explicit RowBins(std::uint64_t rows) : rows_(rows) {
        const unsigned bits = unsigned(std::bit_width(rows)), most_bits = tuning().ranks.row_bin_bits;
        shift_ = bits > most_bits ? bits - most_bits : 0;
    }

    std::size_t size() const { return std::size_t(rows_ >> shift_) + 1; }
    std::size_t bin(const Pair& pair) const { return pair.a >> shift_; }
    /// The first object of a bin, or the end of all.
    std::uint64_t begin(std::size_t bin) const {
        const std::uint64_t row = std::uint64_t(bin) << shift_;
        return row < rows_ ? row : rows_;
    }

private:
    std::uint64_t rows_;
    unsigned shift_;
};

/// Which pairs are wanted: those whose bin has a mark. Borrowed.
struct WantedRows {
    RowBins bins{0};
    std::span<const std::uint8_t> marks = {};  ///< none: all are wanted
};

}  // namespace octopair
