// RowBins: bins of consecutive objects. Pairs are counted, and assigned to ranks, by the bin of their `a`.
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
        const unsigned bits = unsigned(std::bit_width(rows)), max_bits = tuning().ranks.row_bin_bits;
        shift_ = bits > max_bits ? bits - max_bits : 0;
    }

    std::size_t size() const { return std::size_t(rows_ >> shift_) + 1; }
    std::size_t bin(const Pair& pair) const { return pair.a >> shift_; }
    /// Returns the first object of a bin, or the number of objects if there is none.
    std::uint64_t begin(std::size_t bin) const {
        const std::uint64_t row = std::uint64_t(bin) << shift_;
        return row < rows_ ? row : rows_;
    }

private:
    std::uint64_t rows_;
    unsigned shift_;
};

/// Selection of pairs: those whose bin has a nonzero mark. Borrows the marks.
struct WantedRows {
    RowBins bins{0};
    std::span<const std::uint8_t> marks = {};  ///< by bin; empty: all pairs are wanted
};

}  // namespace octopair
