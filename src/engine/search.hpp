// Search: runs a call of an engine: builds the linear octree of all objects once, then scans it into outputs.
//
//   count      Scans once, and counts.
//   octal      Scans once. Passes pairs to the list or the receiver as they are found.
//   ascending  Scans into buckets and sorts these in the list or, for the receiver, in a buffer.
//              If the buffer is too small: scans to count each object's pairs, then scans once for each window of objects
//              whose pairs fit.
//
// With a limit, octal pairs go to the receiver, which ends the scan at the first pair beyond the limit.
//
// Start here to add a new engine: write a class with the functions of `Passes` below, and a class derived from Engine
// (octopair/engine.hpp) that owns it, a Search, a TicketLock and a JobQueue. The smallest one is in threads/local_engine.cpp.
#pragma once

#include <algorithm>
#include <concepts>
#include <cstdint>
#include <functional>
#include <span>
#include <stop_token>
#include <vector>

#include "base/test_hooks.hpp"
#include "base/timed.hpp"
#include "base/tuning.hpp"
#include "boxes/box_source.hpp"
#include "engine/bucket_sort.hpp"
#include "engine/pair_list.hpp"
#include "engine/progress.hpp"
#include "engine/receiver.hpp"
#include "engine/request.hpp"
#include "octopair/error.hpp"

namespace octopair {

/// State of one call, apart from the engine's own memory.
struct Call {
    const detail::Request& request;
    const detail::Output& output;
    const BoxSource& source;
    std::stop_source stop;  ///< requested by the caller, or when a pass fails or is abandoned
    Progress& progress;
    Summary summary;

    /// Returns `Options::buffer_bytes` in pairs, but at least the minimum in tuning.hpp.
    std::uint64_t buffer_pairs() const {
        return std::max(request.options.buffer_bytes, tuning().output.min_buffer_bytes) / sizeof(Pair);
    }
};

/// What an engine does for a Search. build() comes first, then scans. Each scan adds its times to the summary and advances the progress to
/// the fraction `progress`. Lists are empty before, counts are 0.
///   width()            number of threads or workers that share a scan
///   build              builds the octree of the call's objects
///   count              returns the number of pairs
///   count_by_object    adds the number of pairs with object i as `a` to counts[i]
///   list_octal         appends all pairs in octal order
///   stream_octal       passes all pairs to `deliver` in octal order, and buffers at most call.buffer_pairs(). What `deliver` throws ends it
///   list_ascending     appends the pairs within `bounds` in ascending order. Throws OverBudget if the pairs exceed `bounds.max_pairs`
///   end                ends the call: frees references to the caller's data
template <typename T>
concept Passes = requires(T passes, Call& call, detail::PairStorage& list, const AscendingBounds& bounds,
                          std::span<std::uint32_t> counts, const PairSink& deliver, double progress) {
    { passes.width() } -> std::same_as<unsigned>;
    passes.build(call, progress);
    { passes.count(call, progress) } -> std::same_as<std::uint64_t>;
    passes.count_by_object(call, counts, progress);
    passes.list_octal(call, list, progress);
    passes.stream_octal(call, deliver, progress);
    passes.list_ascending(call, list, bounds, progress);
    passes.end();
};

template <Passes Engine>
class Search {
public:
    explicit Search(Engine& passes) : passes_(passes) {}

    Summary run(const detail::Request& request, const detail::Output& output, const detail::Control& control) {
        const BoxSource source(request.first, request.second, request.options.margin);
        Progress progress(control.progress);
        Call call{request, output, source, {}, progress, {}};
        const std::stop_callback forward(control.stop, [&] { call.stop.request_stop(); });
        const CallCleanup cleanup{passes_, held_};
        {
            const Timed timed(call.summary.seconds);
            passes_.build(call, progress_after_build);
            scan(call);
        }
        progress.finish();
        return call.summary;
    }

private:
    /// Progress after the octree is built, as a fraction of the call.
    static constexpr double progress_after_build = 0.3;
    /// Progress of an ascending stream after the pairs are collected. The rest is for the receiver, whose sink may be slow.
    static constexpr double progress_after_collection = 0.6;

    /// Frees the resources that only the call needs when the call ends.
    struct CallCleanup {
        Engine& passes;
        PairList& held;
        ~CallCleanup() {
            detail::storage_of(held).reset();
            passes.end();
        }
    };

    void scan(Call& call) {
        const bool octal = call.request.options.order == Order::octal;
        if (call.output.list == nullptr && call.output.sink == nullptr) {
            count(call);
        } else if (call.output.list != nullptr && !call.request.options.limit) {
            list(call, detail::storage_of(*call.output.list), octal);
        } else {
            Receiver receiver(call.output, call.request.options.limit);
            octal ? stream_octal(call, receiver) : stream_ascending(call, receiver);
        }
    }

    void count(Call& call) {
        const std::uint64_t pairs = passes_.count(call, 1);
        const std::uint64_t limit = call.request.options.limit.value_or(~std::uint64_t(0));
        call.summary.pairs = std::min(limit, pairs);
        call.summary.truncated = pairs > limit;
    }

    void list(Call& call, detail::PairStorage& list, bool octal) {
        if (octal) {
            passes_.list_octal(call, list, 1);
        } else {
            const std::uint64_t objects = call.source.size();
            passes_.list_ascending(call, list, {{0, objects}, objects}, 1);
        }
        call.summary.pairs = list.size;
    }

    void stream_octal(Call& call, Receiver& receiver) {
        receive(call, receiver, [&] {
            passes_.stream_octal(
                call, [&](std::span<const Pair> pairs) { receiver.take(pairs); }, 1);
        });
        call.summary.steps.scan = std::max(0.0, call.summary.steps.scan - receiver.sink_seconds());
    }

    void stream_ascending(Call& call, Receiver& receiver) {
        const std::uint64_t objects = call.source.size();
        detail::storage_of(held_).reset();
        try {
            passes_.list_ascending(call, detail::storage_of(held_), {{0, objects}, objects, call.buffer_pairs()},
                                   progress_after_collection);
        } catch (const OverBudget&) {
            count_path(Path::buffer_over);
            return stream_windows(call, receiver);
        }
        hand_out_held(call, receiver, 1);
    }

    /// Streams ascending pairs that do not fit into the buffer. Counts the pairs of each object. Then collects the pairs of one window of
    /// objects after another; a window has as many objects as have pairs that fit into the buffer.
    void stream_windows(Call& call, Receiver& receiver) {
        const std::uint64_t objects = call.source.size();
        std::vector<std::uint32_t> counts(objects, 0);
        passes_.count_by_object(call, counts, 0.5);
        // A quarter of the buffer is reserved for partly filled pages.
        const std::uint64_t most = call.buffer_pairs() - call.buffer_pairs() / 4;
        ObjectRange window{0, 0};
        while (window.end < objects && !call.summary.truncated) {
            window.begin = window.end;
            if (planted(Fault::stream_windows_overlap) && window.begin > 0) --window.begin;
            std::uint64_t pairs = 0;
            while (window.end < objects && (pairs == 0 || pairs + counts[window.end] <= most)) {
                pairs += counts[window.end++];
            }
            if (pairs == 0) break;
            count_path(pairs > most ? Path::window_of_one : Path::window);
            // A window holds all pairs of at least one object, however many. Each thread also has a few partly filled pages.
            const std::uint64_t room = std::max(call.buffer_pairs(), 2 * pairs) + passes_.width() * 2 * page_pairs();
            const AscendingBounds bounds{window, objects, room, pairs};
            const auto done = [&](double of_window) {
                const double covered = double(window.begin) + of_window * double(window.end - window.begin);
                return 0.5 + 0.5 * covered / double(objects);
            };
            collect_counted(call, bounds, done(0.5));
            hand_out_held(call, receiver, done(1));
        }
    }

    /// Collects the pairs of a window in `held_`. The limit of `bounds` is large enough, because the pairs were counted before.
    void collect_counted(Call& call, const AscendingBounds& bounds, double progress) {
        detail::storage_of(held_).reset();
        try {
            passes_.list_ascending(call, detail::storage_of(held_), bounds, progress);
        } catch (const OverBudget&) {
            throw Error(ErrorCode::engine_failed, "more pairs were found than had been counted");
        }
    }

    /// Passes the pairs of `held_` to `receiver`. Advances the progress to the fraction `progress`.
    void hand_out_held(Call& call, Receiver& receiver, double progress) {
        call.progress.stage(progress, detail::storage_of(held_).size);
        receive(call, receiver, [&] {
            for (auto chunk : detail::storage_of(held_).chunks) {
                while (!chunk.empty()) {
                    const auto some = chunk.first(std::min(chunk.size(), tuning().output.max_pairs_per_sink_call));
                    receiver.take(some);
                    call.progress.add(some.size());
                    chunk = chunk.subspan(some.size());
                }
            }
        });
    }

    template <typename Give>
    static void receive(Call& call, Receiver& receiver, Give&& give) {
        receiver.receive(give);
        call.summary.pairs = receiver.pairs();
        call.summary.truncated = receiver.truncated();
    }

    Engine& passes_;
    PairList held_;  // ascending pairs that the receiver gets next
};

}  // namespace octopair
