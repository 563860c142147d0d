// The SIMD version of the sweep, compiled for each instruction set by Highway and chosen at run time.
//
// A run of columns is one register wide. Its hits are queued as a mask without a branch on whether there are any: dense
// scenes mispredict that branch, and draining the queue apart from the sweep was 1.5 times faster there.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "octree/sweep_kernel.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include <array>
#include <limits>

#include "octree/sweep.hpp"

HWY_BEFORE_NAMESPACE();
namespace octopair {
namespace HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

constexpr std::size_t runs_per_call = std::size_t(1) << 20;  // a few milliseconds: then the caller looks for a stop

template <typename D, typename M>
std::uint32_t bits_of(D d, M mask) {
    std::uint8_t bytes[8] = {};
    hn::StoreMaskBits(d, mask, bytes);
    return std::uint32_t(bytes[0]) | std::uint32_t(bytes[1]) << 8;
}

std::size_t sweep_rows_simd(const Sweep& sweep, SweepCursor& cursor, std::span<HitMask> hits) {
    const SweepSet& rows = sweep.rows;
    const SweepSet& columns = sweep.columns;
    using Floats = hn::CappedTag<float, most_hits>;  // a register, at most the bits of a HitMask
    const Floats d;
    const hn::RebindToUnsigned<Floats> du;
    const std::size_t lanes = hn::Lanes(d);
    const std::array<const float*, 6> row_bounds = {rows.low(0),  rows.low(1),  rows.low(2),
                                                    rows.high(0), rows.high(1), rows.high(2)};
    const float* const low0 = columns.low(0);
    const float* const low1 = columns.low(1);
    const float* const low2 = columns.low(2);
    const float* const high1 = columns.high(1);
    const float* const high2 = columns.high(2);
    const std::uint32_t* const masks = columns.mask();

    HitMask* hit_at = hits.data();
    HitMask* const hits_end = hits.data() + hits.size();
    std::size_t runs_left = runs_per_call;
    for (; cursor.row < cursor.row_end; ++cursor.row, cursor.in_row = false) {
        start_row(sweep, cursor);
        const std::size_t row = cursor.row;
        const float end = row_bounds[3][row];
        const auto row_end = hn::Set(d, end);
        const auto row_low1 = hn::Set(d, row_bounds[1][row]);
        const auto row_low2 = hn::Set(d, row_bounds[2][row]);
        const auto row_high1 = hn::Set(d, row_bounds[4][row]);
        const auto row_high2 = hn::Set(d, row_bounds[5][row]);
        const auto row_mask = hn::Set(du, rows.mask()[row]);
        std::size_t column = cursor.column;
        // The padding's NaN ends the columns of a set; a run may read into it.
        for (; low0[column] <= end; column += lanes) {
            if (hit_at == hits_end || --runs_left == 0) {
                cursor.column = column;
                return std::size_t(hit_at - hits.data());
            }
            const auto on0 = hn::Le(hn::LoadU(d, low0 + column), row_end);
            const auto on1 =
                hn::And(hn::Le(hn::LoadU(d, low1 + column), row_high1), hn::Ge(hn::LoadU(d, high1 + column), row_low1));
            const auto on2 =
                hn::And(hn::Le(hn::LoadU(d, low2 + column), row_high2), hn::Ge(hn::LoadU(d, high2 + column), row_low2));
            const auto shared = hn::And(hn::LoadU(du, masks + column), row_mask);
            const auto apart = hn::RebindMask(d, hn::Eq(shared, hn::Zero(du)));
            const std::uint32_t bits = bits_of(d, hn::And(hn::And(on0, on1), hn::And(on2, apart)));
            *hit_at = {std::uint32_t(row), std::uint32_t(column), bits};
            hit_at += bits != 0 ? 1 : 0;
        }
    }
    return std::size_t(hit_at - hits.data());
}

/// For each set of lanes their numbers, ascending, and how many they are. (Highway's own table for this is copied on
/// each use by g++ 12.)
struct LaneTable {
    static constexpr std::size_t lanes = 8;
    std::array<std::array<std::uint8_t, lanes>, 1 << lanes> of{};
    std::array<std::uint8_t, 1 << lanes> count{};

    constexpr LaneTable() {
        for (std::size_t set = 0; set < of.size(); ++set) {
            for (std::uint8_t lane = 0; lane < lanes; ++lane) {
                if (set >> lane & 1u) of[set][count[set]++] = lane;
            }
        }
    }
};
constexpr LaneTable lanes_in;

std::size_t pairs_of_hits_simd(const Sweep& sweep, std::span<const HitMask> hits, std::uint32_t second_begin,
                               Pair* pairs) {
    const hn::CappedTag<std::uint32_t, LaneTable::lanes> d;
    const hn::Rebind<std::uint8_t, decltype(d)> bytes;
    const auto offset = hn::Set(d, second_begin);
    const std::uint32_t* const rows = sweep.rows.object();
    const std::uint32_t* const columns = sweep.columns.object();
    std::uint32_t* const begin = reinterpret_cast<std::uint32_t*>(pairs);
    std::uint32_t* at = begin;
    for (const HitMask& hit : hits) {
        const auto row = hn::Set(d, rows[hit.row]);
        const std::uint32_t* column = columns + hit.first;
        for (std::uint32_t bits = hit.bits; bits != 0; bits >>= LaneTable::lanes, column += LaneTable::lanes) {
            // All lanes are written, and what lies beyond the hits is written over by the next ones.
            const std::uint32_t set = bits & (lanes_in.of.size() - 1);
            const auto lanes = hn::PromoteTo(d, hn::LoadU(bytes, lanes_in.of[set].data()));
            const auto hit_columns = hn::TableLookupLanes(hn::LoadU(d, column), hn::IndicesFromVec(d, lanes));
            const auto high = hn::Sub(hn::Max(row, hit_columns), offset);
            hn::StoreInterleaved2(hn::Min(row, hit_columns), high, d, at);
            at += 2 * std::size_t(lanes_in.count[set]);
        }
    }
    return std::size_t(at - begin) / 2;
}

void keep_certain_simd(const Sweep& sweep, const RoundingSlack& slack, std::span<HitMask> hits) {
    const hn::CappedTag<float, most_hits> d;
    const auto part = hn::Set(d, RoundingSlack::part);
    const auto largest = hn::Set(d, std::numeric_limits<float>::max());
    for (HitMask& hit : hits) {
        std::uint32_t bits = hit.bits;
        for (unsigned k = 0; k < 3; ++k) {
            const auto row_low = hn::Set(d, sweep.rows.low(k)[hit.row]);
            const auto row_high = hn::Set(d, sweep.rows.high(k)[hit.row]);
            const auto low = hn::LoadU(d, sweep.columns.low(k) + hit.first);
            const auto high = hn::LoadU(d, sweep.columns.high(k) + hit.first);
            const auto size =
                hn::Add(hn::Max(hn::Abs(row_low), hn::Abs(row_high)), hn::Max(hn::Abs(low), hn::Abs(high)));
            const auto depth = hn::Min(hn::Sub(row_high, low), hn::Sub(high, row_low));
            const auto needed = hn::Add(hn::Mul(size, part), hn::Set(d, slack.base[sweep.rows.axis(k)]));
            bits &= bits_of(d, hn::And(hn::Gt(depth, needed), hn::Lt(size, largest)));
        }
        hit.bits = bits;
    }
}

}  // namespace HWY_NAMESPACE
}  // namespace octopair
HWY_AFTER_NAMESPACE();

#if HWY_ONCE

namespace octopair {

HWY_EXPORT(sweep_rows_simd);
HWY_EXPORT(pairs_of_hits_simd);
HWY_EXPORT(keep_certain_simd);

std::size_t sweep_rows(const Sweep& sweep, SweepCursor& cursor, std::span<HitMask> hits) {
    return HWY_DYNAMIC_DISPATCH(sweep_rows_simd)(sweep, cursor, hits);
}

std::size_t pairs_of_hits(const Sweep& sweep, std::span<const HitMask> hits, std::uint32_t second_begin, Pair* pairs) {
    return HWY_DYNAMIC_DISPATCH(pairs_of_hits_simd)(sweep, hits, second_begin, pairs);
}

void keep_certain(const Sweep& sweep, const RoundingSlack& slack, std::span<HitMask> hits) {
    HWY_DYNAMIC_DISPATCH(keep_certain_simd)(sweep, slack, hits);
}

std::string sweep_instruction_set() {
    // The best of the supported targets is the one with the lowest bit set.
    const auto supported = hwy::SupportedTargets();
    return hwy::TargetName(supported & (~supported + 1));
}

void restrict_sweep_to_baseline(bool baseline_only) {
    hwy::DisableTargets(baseline_only ? ~(HWY_STATIC_TARGET) : 0);
    hwy::GetChosenTarget().DeInit();
}

}  // namespace octopair

#endif  // HWY_ONCE
