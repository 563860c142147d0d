#include "engine/search.hpp"

#include <algorithm>
#include <vector>

#include "base/test_hooks.hpp"
#include "base/timed.hpp"
#include "base/tuning.hpp"
#include "engine/pair_pages.hpp"
#include "engine/receiver.hpp"
#include "octopair/error.hpp"

namespace octopair {

namespace {

/// Progress after the octree is built, as a fraction of the call.
constexpr double progress_after_build = 0.3;
/// Progress of an ascending stream after the pairs are collected. The rest is for the receiver, whose sink may be slow.
constexpr double progress_after_collection = 0.6;

/// Frees the resources that only the call needs when the call ends.
struct CallCleanup {
    Passes& passes;
    PairList& held;
    ~CallCleanup() {
        detail::storage_of(held).reset();
        passes.end();
    }
};

}  // namespace

Summary Search::run(const detail::Request& request, const detail::Output& output, const detail::Control& control) {
    const BoxSource source(request.first, request.second, request.options.margin);
    Progress progress(control.progress);
    Call call{request, output, source, {}, progress, {}};
    const std::stop_callback forward(control.stop, [&] { call.stop.request_stop(); });
    const CallCleanup cleanup{passes_, held_};
    find(call);
    progress.finish();
    return call.summary;
}

void Search::find(Call& call) {
    const Timed timed(call.summary.seconds);
    passes_.build(call, progress_after_build);
    if (call.output.list == nullptr && call.output.sink == nullptr) {
        count(call);
    } else if (call.request.options.order == Order::octal) {
        find_octal(call);
    } else {
        find_ascending(call);
    }
}

void Search::count(Call& call) {
    const std::uint64_t pairs = passes_.count(call, 1);
    const std::uint64_t limit = call.request.options.limit.value_or(~std::uint64_t(0));
    call.summary.pairs = std::min(limit, pairs);
    call.summary.truncated = pairs > limit;
}

void Search::find_octal(Call& call) {
    if (call.output.list != nullptr && !call.request.options.limit) {
        detail::PairStorage& list = detail::storage_of(*call.output.list);
        passes_.list_octal(call, list, 1);
        call.summary.pairs = list.size;
        return;
    }
    Receiver receiver(call.output, call.request.options.limit);
    receive(call, receiver, [&] {
        passes_.stream_octal(
            call, [&](std::span<const Pair> pairs) { receiver.take(pairs); }, 1);
    });
    call.summary.steps.scan = std::max(0.0, call.summary.steps.scan - receiver.sink_seconds());
}

void Search::find_ascending(Call& call) {
    const ObjectRange all{0, call.source.size()};
    if (call.output.list != nullptr && !call.request.options.limit) {
        detail::PairStorage& list = detail::storage_of(*call.output.list);
        passes_.list_ascending(call, list, {all, all.end}, 1);
        call.summary.pairs = list.size;
        return;
    }
    Receiver receiver(call.output, call.request.options.limit);
    detail::storage_of(held_).reset();
    try {
        passes_.list_ascending(call, detail::storage_of(held_), {all, all.end, call.buffer_pairs()},
                               progress_after_collection);
    } catch (const OverBudget&) {
        count_path(Path::buffer_over);
        return find_windows(call, receiver);
    }
    hand_out_held(call, receiver, 1);
}

/// Collects the pairs of a window in `held_`. The limit of `bounds` is large enough, because the pairs were counted before.
void Search::collect_counted(Call& call, const AscendingBounds& bounds, double progress) {
    detail::storage_of(held_).reset();
    try {
        passes_.list_ascending(call, detail::storage_of(held_), bounds, progress);
    } catch (const OverBudget&) {
        throw Error(ErrorCode::engine_failed, "more pairs were found than had been counted");
    }
}

void Search::hand_out_held(Call& call, Receiver& receiver, double progress) {
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

/// Streams ascending pairs that do not fit into the buffer. Counts the pairs of each object. Then collects the pairs of one window of
/// objects after another; a window has as many objects as have pairs that fit into the buffer.
void Search::find_windows(Call& call, Receiver& receiver) {
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

template <typename Give>
void Search::receive(Call& call, Receiver& receiver, Give&& give) {
    try {
        give();
    } catch (const Receiver::LimitReached&) {
        count_path(Path::limit_reached);
    }
    receiver.flush();
    call.summary.pairs = receiver.pairs();
    call.summary.truncated = receiver.truncated();
}

}  // namespace octopair
