// PairStream: passes the pairs of a call to its sink, or to its list up to a limit, in order, through bounded memory.
//
//   octal      Scans once. Passes pairs to the receiver as they are found. The receiver ends the scan at the first pair beyond the limit.
//   ascending  Scans into buckets and sorts these in a buffer, which the receiver gets. If the buffer is too small: scans to count each
//              object's pairs, then scans once for each window of objects whose pairs fit.
//
// Both count the pairs first if these may be too many for the receiver (pair_room.hpp).
#pragma once

#include <algorithm>
#include <cstdint>
#include <numeric>
#include <span>
#include <vector>

#include "base/test_hooks.hpp"
#include "base/tuning.hpp"
#include "engine/passes.hpp"
#include "engine/receiver.hpp"
#include "octopair/error.hpp"

namespace octopair {

/// Counts the pairs of a call whose scan was abandoned. Throws: TooManyPairs if they do not fit.
template <Passes P>
void count_ahead(P& passes, Call& call) {
    constexpr double counting_part = 0.2;  // of the progress that is left
    count_path(Path::counted_ahead);
    call.progress.abandon_stage();
    const double begin = call.progress.end();
    call.room->require(passes.count(call, begin + counting_part * (1 - begin), call.room->count_limit()));
}

/// Requires: `call.room` is set.
template <Passes P>
class PairStream {
public:
    /// `held`: memory for ascending pairs that the receiver gets next. Borrows all arguments.
    PairStream(P& passes, Call& call, PairList& held)
        : passes_(passes),
          call_(call),
          held_(detail::storage_of(held)),
          receiver_(call.output, call.request.options.limit) {}

    void octal() {
        std::uint64_t skipped = 0;  // pairs that an abandoned scan has delivered
        const auto take = [&](std::span<const Pair> pairs) {
            const std::size_t again = std::size_t(std::min<std::uint64_t>(skipped, pairs.size()));
            skipped -= again;
            const auto fresh = pairs.subspan(again);
            if (call_.room->is_doubtful(receiver_.pairs() + fresh.size())) throw OverBudget{};
            receiver_.take(fresh);
        };
        receive([&] {
            try {
                passes_.stream_octal(call_, take, 1);
            } catch (const OverBudget&) {
                count_ahead(passes_, call_);
                skipped = receiver_.pairs();
                passes_.stream_octal(call_, take, 1);
            }
        });
        call_.summary.steps.scan = std::max(0.0, call_.summary.steps.scan - receiver_.sink_seconds());
    }

    void ascending() {
        const std::uint64_t objects = call_.source.size();
        held_.reset();
        try {
            passes_.list_ascending(call_, held_, {{0, objects}, objects, call_.buffer_pairs()},
                                   progress_after_collection);
        } catch (const OverBudget&) {
            count_path(Path::buffer_over);
            if (call_.room->is_doubtful(call_.buffer_pairs())) {
                count_ahead(passes_, call_);
            } else {
                call_.progress.abandon_stage();
            }
            return windows();
        }
        call_.room->require({held_.size});
        hand_out_held(1);
    }

private:
    /// Progress of an ascending stream after the pairs are collected. The rest is for the receiver, whose sink may be slow.
    static constexpr double progress_after_collection = 0.6;

    /// Streams ascending pairs that do not fit into the buffer. Counts the pairs of each object. Then collects the pairs of one window of
    /// objects after another. A window is the next objects whose pairs together fit into the buffer, and at least one object.
    void windows() {
        const std::uint64_t objects = call_.source.size();
        std::vector<std::uint32_t> counts(objects, 0);
        passes_.count_by_object(call_, counts, 0.5);
        call_.room->require({std::accumulate(counts.begin(), counts.end(), std::uint64_t(0))});
        // A quarter of the buffer is reserved for partly filled pages.
        const std::uint64_t most = call_.buffer_pairs() - call_.buffer_pairs() / 4;
        ObjectRange window{0, 0};
        while (window.end < objects && !call_.summary.truncated) {
            window.begin = window.end;
            if (planted(Fault::stream_windows_overlap) && window.begin > 0) --window.begin;
            std::uint64_t pairs = 0;
            while (window.end < objects && (pairs == 0 || pairs + counts[window.end] <= most)) {
                pairs += counts[window.end++];
            }
            if (pairs == 0) break;
            count_path(pairs > most ? Path::window_of_one : Path::window);
            // A window holds all pairs of at least one object, however many. Each thread also has a few partly filled pages.
            const std::uint64_t room = std::max(call_.buffer_pairs(), 2 * pairs) + passes_.width() * 2 * page_pairs();
            const AscendingBounds bounds{window, objects, room, pairs};
            const auto done = [&](double of_window) {
                const double covered = double(window.begin) + of_window * double(window.end - window.begin);
                return 0.5 + 0.5 * covered / double(objects);
            };
            collect_counted(bounds, done(0.5));
            hand_out_held(done(1));
        }
    }

    /// Collects the pairs of a window in `held_`. The limit of `bounds` is large enough, because the pairs were counted before.
    void collect_counted(const AscendingBounds& bounds, double progress) {
        held_.reset();
        try {
            passes_.list_ascending(call_, held_, bounds, progress);
        } catch (const OverBudget&) {
            throw Error(ErrorCode::engine_failed, "more pairs were found than had been counted");
        }
    }

    /// Passes the pairs of `held_` to the receiver. Advances the progress to the fraction `progress`.
    void hand_out_held(double progress) {
        call_.progress.stage(progress, held_.size);
        receive([&] {
            for (auto chunk : held_.chunks) {
                while (!chunk.empty()) {
                    const auto some = chunk.first(std::min(chunk.size(), tuning().output.max_pairs_per_sink_call));
                    receiver_.take(some);
                    call_.progress.add(some.size());
                    chunk = chunk.subspan(some.size());
                }
            }
        });
    }

    template <typename Give>
    void receive(Give&& give) {
        receiver_.receive(give);
        call_.summary.pairs = receiver_.pairs();
        call_.summary.truncated = receiver_.truncated();
    }

    P& passes_;
    Call& call_;
    detail::PairStorage& held_;
    Receiver receiver_;
};

}  // namespace octopair
