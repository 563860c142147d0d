// SIMD version of sort_rows(). Highway compiles this file for each instruction set. The place of an object is the number of smaller
// objects in its row, so no branch depends on the order of the objects. A row has equal objects only after a fault elsewhere. Equal
// objects would get one place, so the sum of all places would be too small. Then sort_rows_scalar() sorts the rows again.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "boxes/row_sort.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include <algorithm>
#include <bit>

#include "boxes/row_sort.hpp"

HWY_BEFORE_NAMESPACE();
namespace octopair {
namespace HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

#if HWY_TARGET == HWY_SCALAR

bool sort_rows_simd(const PairRows&, Pair*) { return false; }

#else

using Words = hn::CappedTag<std::uint32_t, 8>;
using SignedWords = hn::RebindToSigned<Words>;
using Lanes = hn::Vec<SignedWords>;

/// Returns objects in the order of signed integers.
HWY_INLINE Lanes load(const std::uint32_t* objects) {
    const Words d;
    return hn::BitCast(SignedWords(), hn::Xor(hn::LoadU(d, objects), hn::Set(d, 0x80000000u)));
}

/// Returns the number of lanes, among the first `count`, that are less than `value`.
HWY_INLINE std::size_t count_less(const Lanes& lanes, const Lanes& value, std::size_t count) {
    const SignedWords d;
    std::uint8_t bits[8] = {};
    hn::StoreMaskBits(d, hn::Lt(lanes, value), bits);
    return std::size_t(std::popcount(std::uint32_t(bits[0]) & ((1u << count) - 1)));
}

/// Sorts the rows. Returns false if two objects of a row are equal; then `out` lacks some pairs.
bool sort_rows_simd(const PairRows& rows, Pair* out) {
    const SignedWords d;
    const auto& [seconds, first_begin, ends, first_object] = rows;
    std::uint32_t begin = first_begin;
    const std::size_t lanes = hn::Lanes(d);
    std::size_t missing = 0;  // sum of all places in the rows, minus the sum of the places that objects got
    for (std::size_t row = 0; row < ends.size(); ++row) {
        const std::uint32_t a = first_object + std::uint32_t(row);
        const std::uint32_t* const objects = seconds + begin;
        const std::size_t size = ends[row] - begin;
        begin = ends[row];
        if (size <= lanes) {
            const auto all = load(objects);
            for (std::size_t i = 0; i < size; ++i) {
                const auto value = hn::Set(d, std::int32_t(objects[i] ^ 0x80000000u));
                const std::size_t place = count_less(all, value, size);
                missing += i - place;
                out[place] = {a, objects[i]};
            }
        } else {
            for (std::size_t i = 0; i < size; ++i) {
                const auto value = hn::Set(d, std::int32_t(objects[i] ^ 0x80000000u));
                std::size_t place = 0;
                for (std::size_t k = 0; k < size; k += lanes) {
                    place += count_less(load(objects + k), value, std::min(lanes, size - k));
                }
                missing += i - place;
                out[place] = {a, objects[i]};
            }
        }
        out += size;
    }
    return missing == 0;
}

#endif

}  // namespace HWY_NAMESPACE
}  // namespace octopair
HWY_AFTER_NAMESPACE();

#if HWY_ONCE

namespace octopair {

HWY_EXPORT(sort_rows_simd);

void sort_rows(const PairRows& rows, Pair* out) {
    if (!HWY_DYNAMIC_DISPATCH(sort_rows_simd)(rows, out)) sort_rows_scalar(rows, out);
}

void sort_rows_scalar(const PairRows& rows, Pair* out) {
    std::uint32_t at = rows.begin;
    for (std::size_t row = 0; row < rows.ends.size(); ++row) {
        Pair* const row_begin = out;
        for (; at < rows.ends[row]; ++at) *out++ = {rows.first_object + std::uint32_t(row), rows.seconds[at]};
        std::sort(row_begin, out, [](const Pair& x, const Pair& y) { return x.b < y.b; });
    }
}

}  // namespace octopair

#endif  // HWY_ONCE
