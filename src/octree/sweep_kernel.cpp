// The SIMD version of the sweep, compiled for each instruction set by Highway and chosen at run time.
//
// A run of columns is one register wide. Its hits are queued as a mask without a branch on whether there are any: dense
// scenes mispredict that branch, and draining the queue apart from the sweep was 1.5 times faster there.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "octree/sweep_kernel.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "octree/sweep.hpp"

HWY_BEFORE_NAMESPACE();
namespace octopair {
namespace HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

constexpr std::size_t runs_per_call = std::size_t(1) << 20;  // a few milliseconds: then the caller looks for a stop

std::size_t sweep_rows_simd(const Sweep& sweep, SweepCursor& cursor, std::span<HitMask> hits) {
    const SweepSet& rows = sweep.rows;
    const SweepSet& columns = sweep.columns;
    using Floats = hn::CappedTag<float, 16>;  // a register, at most the bits of a HitMask and the padding of a set
    const Floats d;
    const hn::RebindToUnsigned<Floats> du;
    const std::size_t lanes = hn::Lanes(d);
    const float* const low0 = columns.low(0);
    const float* const low1 = columns.low(1);
    const float* const low2 = columns.low(2);
    const float* const high1 = columns.high(1);
    const float* const high2 = columns.high(2);
    const std::uint32_t* const masks = columns.mask();

    std::size_t written = 0;
    std::size_t runs = 0;
    for (; cursor.row < cursor.row_end; ++cursor.row, cursor.in_row = false) {
        start_row(sweep, cursor);
        const std::size_t row = cursor.row;
        const float end = rows.high(0)[row];
        const auto row_end = hn::Set(d, end);
        const auto row_low1 = hn::Set(d, rows.low(1)[row]);
        const auto row_low2 = hn::Set(d, rows.low(2)[row]);
        const auto row_high1 = hn::Set(d, rows.high(1)[row]);
        const auto row_high2 = hn::Set(d, rows.high(2)[row]);
        const auto row_mask = hn::Set(du, rows.mask()[row]);
        std::size_t column = cursor.column;
        // The padding's NaN ends the columns of a set; a run may read into it.
        while (column < columns.size() && low0[column] <= end) {
            if (written == hits.size() || ++runs > runs_per_call) {
                cursor.column = column;
                return written;
            }
            const auto on0 = hn::Le(hn::LoadU(d, low0 + column), row_end);
            const auto on1 =
                hn::And(hn::Le(hn::LoadU(d, low1 + column), row_high1), hn::Ge(hn::LoadU(d, high1 + column), row_low1));
            const auto on2 =
                hn::And(hn::Le(hn::LoadU(d, low2 + column), row_high2), hn::Ge(hn::LoadU(d, high2 + column), row_low2));
            const auto shared = hn::And(hn::LoadU(du, masks + column), row_mask);
            const auto apart = hn::RebindMask(d, hn::Eq(shared, hn::Zero(du)));
            const auto hit = hn::And(hn::And(on0, on1), hn::And(on2, apart));
            std::uint8_t bytes[8] = {};
            hn::StoreMaskBits(d, hit, bytes);
            const std::uint32_t bits = std::uint32_t(bytes[0]) | std::uint32_t(bytes[1]) << 8;
            hits[written] = {std::uint32_t(row), std::uint32_t(column), bits};
            written += bits != 0 ? 1 : 0;
            column += lanes;
        }
    }
    return written;
}

}  // namespace HWY_NAMESPACE
}  // namespace octopair
HWY_AFTER_NAMESPACE();

#if HWY_ONCE

namespace octopair {

HWY_EXPORT(sweep_rows_simd);

std::size_t sweep_rows(const Sweep& sweep, SweepCursor& cursor, std::span<HitMask> hits) {
    return HWY_DYNAMIC_DISPATCH(sweep_rows_simd)(sweep, cursor, hits);
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
