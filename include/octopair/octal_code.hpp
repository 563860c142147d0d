// OctalCode: the path of octant digits from the root of an octree (the paper's octnode code).
//
// - A code of level L has L digits 0..7, most significant first. The root has level 0.
// - `key` holds the digits left-aligned in 3 * 21 bits; bits below the level are 0. The level is stored separately.
// - The order by (key, level) is the pre-order of the octree: an octant comes directly before all octants below it.
//
// Two written forms use the paper's digits 1..8 (our digit + 1); a 0 means "no octant at this level":
//   text     "{3,1,4}": the path; "{}" is the root
//   integer  314, or padded to a tree of depth 5: 31400. At most 19 digits (a uint64).
//
// Source: Lucchesi, Egbert, Harris 2014, sections 3.2 and 3.3 (CommonPath, figure 4); Samet 1984 for the pre-order.
#pragma once

#include <array>
#include <compare>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>

namespace [[gnu::visibility("default")]] octopair {

class OctalCode {
public:
    static constexpr unsigned max_level = 21;

    /// Makes the root.
    constexpr OctalCode() = default;
    /// Returns the code with these digits 0..7, root first.
    /// Throws: Error{bad_input} for a digit above 7 or more than max_level digits.
    static OctalCode from_digits(std::span<const std::uint8_t> digits);
    /// Returns the octant of `level` that contains the cell (x, y, z) of the deepest level. Bit 0 of a digit is x, bit 1 y, bit
    /// 2 z. Requires: x, y, z < 2^max_level; level <= max_level.
    static constexpr OctalCode from_cell(std::array<std::uint32_t, 3> cell, unsigned level);
    /// Parses the text form. Accepts spaces, and trailing zeros after the path, as in {1,2,6,0,0}.
    /// Throws: Error{bad_input} for any other text.
    static OctalCode from_text(std::string_view text);
    /// Returns the code of the integer form. Throws: Error{bad_input} for a digit 9 or a zero before another digit.
    static OctalCode from_integer(std::uint64_t integer);

    constexpr unsigned level() const { return level_; }
    /// Returns the digits as one number, left-aligned in 63 bits.
    constexpr std::uint64_t key() const { return key_; }
    /// Returns the digit of level i + 1, 0..7. Requires: i < level().
    constexpr unsigned digit(unsigned i) const { return unsigned(key_ >> shift_below(i + 1)) & 7u; }
    /// Returns the octant one level above. The root is its own parent.
    constexpr OctalCode parent() const { return level_ == 0 ? *this : ancestor(level_ - 1); }
    /// Returns the octant at `level` on the path to this octant. Requires: level <= level().
    constexpr OctalCode ancestor(unsigned level) const {
        return OctalCode(key_ >> shift_below(level) << shift_below(level), level);
    }
    /// Returns the child `digit`. Requires: digit <= 7; level() < max_level.
    constexpr OctalCode child(unsigned digit) const {
        return OctalCode(key_ | std::uint64_t(digit) << shift_below(level_ + 1u), level_ + 1u);
    }
    /// Returns true if `other` is this octant or below it.
    constexpr bool contains(OctalCode other) const {
        return level_ <= other.level_ && other.ancestor(level_).key_ == key_;
    }

    /// Returns the text form.
    std::string text() const;
    /// Returns the integer form, padded with zeros to `depth` digits; 0: not padded.
    /// Throws: Error{bad_input} if that has more than 19 digits, or if 0 < depth < level().
    std::uint64_t integer(unsigned depth = 0) const;

    friend constexpr bool operator==(OctalCode, OctalCode) = default;
    /// Compares by pre-order.
    friend constexpr std::strong_ordering operator<=>(OctalCode a, OctalCode b) {
        return a.key_ != b.key_ ? a.key_ <=> b.key_ : a.level_ <=> b.level_;
    }

private:
    constexpr OctalCode(std::uint64_t key, unsigned level) : key_(key), level_(std::uint8_t(level)) {}
    static constexpr unsigned shift_below(unsigned level) { return 3 * (max_level - level); }

    std::uint64_t key_ = 0;
    std::uint8_t level_ = 0;
};

/// Returns true if one octant contains the other, or both are the same. The paper's CommonPath.
constexpr bool common_path(OctalCode a, OctalCode b) { return a.contains(b) || b.contains(a); }

constexpr OctalCode OctalCode::from_cell(std::array<std::uint32_t, 3> cell, unsigned level) {
    std::uint64_t key = 0;
    for (unsigned i = 0; i < max_level; ++i) {
        const unsigned bit = max_level - 1 - i;
        const std::uint64_t digit = (cell[0] >> bit & 1u) | (cell[1] >> bit & 1u) << 1 | (cell[2] >> bit & 1u) << 2;
        key |= digit << shift_below(i + 1);
    }
    return OctalCode(key, max_level).ancestor(level);
}

}  // namespace octopair
