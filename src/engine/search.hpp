// Search: runs a call of an engine: builds the linear octree of all objects once, then scans it into outputs.
//
//   count      Scans once, and counts.
//   octal      Scans once. Pairs go to the list as they are found.
//   ascending  Scans into buckets and sorts these in the list.
//
// Pairs for a sink, and lists with a limit, are streamed (pair_stream.hpp). The MPI engine has RankSearch in place of this class.
#pragma once

#include <algorithm>
#include <cstdint>
#include <stop_token>

#include "base/timed.hpp"
#include "engine/pair_stream.hpp"
#include "engine/passes.hpp"

namespace octopair {

template <Passes P>
class Search {
public:
    explicit Search(P& passes) : passes_(passes) {}

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

    /// Frees the resources that only the call needs when the call ends.
    struct CallCleanup {
        P& passes;
        PairList& held;
        ~CallCleanup() {
            detail::storage_of(held).reset();
            passes.end();
        }
    };

    void scan(Call& call) {
        const bool octal = call.request.options.order == Order::octal;
        if (call.output.list == nullptr && call.output.sink == nullptr) return count(call);
        detail::PairStorage* const list_storage =
            call.output.list != nullptr ? &detail::storage_of(*call.output.list) : nullptr;
        PairRoom room({call.request.options.limit, call.output.max_pairs}, list_storage, call.progress);
        call.room = &room;
        if (list_storage != nullptr && !call.request.options.limit) {
            list(call, *list_storage, octal);
        } else {
            PairStream<P> stream(passes_, call, held_);
            octal ? stream.octal() : stream.ascending();
        }
    }

    void count(Call& call) {
        const std::uint64_t pairs = passes_.count(call, 1, {}).pairs;
        const std::uint64_t limit = call.request.options.limit.value_or(~std::uint64_t(0));
        call.summary.pairs = std::min(limit, pairs);
        call.summary.truncated = pairs > limit;
    }

    void list(Call& call, detail::PairStorage& list, bool octal) {
        const std::uint64_t objects = call.source.size();
        const auto fill = [&] {
            octal ? passes_.list_octal(call, list, 1) : passes_.list_ascending(call, list, {{0, objects}, objects}, 1);
        };
        try {
            fill();
        } catch (const OverBudget&) {
            list.reset();
            count_ahead(passes_, call);
            fill();
        }
        call.summary.pairs = list.size;
    }

    P& passes_;
    PairList held_;  // ascending pairs that a stream gets next; keeps its memory between calls
};

}  // namespace octopair
