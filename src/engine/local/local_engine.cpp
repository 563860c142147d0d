// The local engine: the steps of the algorithm on the threads of this process.
//
//   build   the linear octree of all objects, once a call
//   octal   scan once, pairs to a list or to the receiver as they come
//   ascending  scan into a buffer and sort it. Where the buffer is too small: scan to count each object's pairs, then
//           once for every window of objects whose pairs fit.
// With a limit, octal pairs are received one by one and the scan is abandoned after the first pair too many.

#include <algorithm>
#include <chrono>
#include <mutex>
#include <optional>
#include <stop_token>

#include "engine/local/ascending.hpp"
#include "engine/local/progress.hpp"
#include "engine/local/writers.hpp"
#include "engine/request.hpp"
#include "geometry/box_source.hpp"
#include "octopair/error.hpp"
#include "octree/linear_octree.hpp"
#include "octree/scan.hpp"

namespace octopair {

namespace {

constexpr std::uint64_t least_buffer_bytes = 1 << 20;
constexpr double built = 0.3;  // of the progress

double seconds_since(std::chrono::steady_clock::time_point begin) {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
}

/// Receives pairs in their final order, up to the limit.
class Receiver {
public:
    Receiver(const Engine::Output& output, std::optional<std::uint64_t> limit) : output_(output), limit_(limit) {}

    struct LimitReached {};

    /// Throws LimitReached at the first pair beyond the limit.
    void take(std::span<const Pair> pairs) {
        const std::uint64_t room = limit_ ? *limit_ - pairs_ : ~std::uint64_t(0);
        const auto kept = pairs.first(std::size_t(std::min<std::uint64_t>(pairs.size(), room)));
        pairs_ += kept.size();
        if (!kept.empty()) deliver(kept);
        if (kept.size() < pairs.size()) {
            truncated_ = true;
            throw LimitReached{};
        }
    }

    void flush() {
        if (held_.empty()) return;
        (*output_.sink)(held_);
        held_.clear();
    }

    std::uint64_t pairs() const { return pairs_; }
    bool truncated() const { return truncated_; }

private:
    void deliver(std::span<const Pair> pairs) {
        constexpr std::size_t worth_a_call = 1 << 13;  // pairs; small batches are put together
        if (output_.list != nullptr) return keep(pairs);
        if (held_.size() + pairs.size() > worth_a_call) flush();
        if (pairs.size() >= worth_a_call) {
            (*output_.sink)(pairs);
        } else {
            held_.insert(held_.end(), pairs.begin(), pairs.end());
        }
    }

    void keep(std::span<const Pair> pairs) {
        PairList::Storage& list = output_.list->storage();
        if (block_.size() < pairs.size()) block_ = list.take_block(pairs.size());
        std::copy(pairs.begin(), pairs.end(), block_.begin());
        list.append(block_.first(pairs.size()));
        block_ = block_.subspan(pairs.size());
    }

    const Engine::Output& output_;
    std::optional<std::uint64_t> limit_;
    std::uint64_t pairs_ = 0;
    bool truncated_ = false;
    std::vector<Pair> held_;
    std::span<Pair> block_;
};

/// What one call needs, beside the engine's own memory.
struct Call {
    const Engine::Request& request;
    const Engine::Output& output;
    const BoxSource& source;
    std::stop_source stop;
    Progress& progress;
    Summary summary;

    std::uint64_t buffer_pairs() const {
        return std::max(request.options.buffer_bytes, least_buffer_bytes) / sizeof(Pair);
    }
};

class LocalEngine final : public Engine {
public:
    explicit LocalEngine(unsigned threads) : team_(threads) {}

private:
    Summary run(const Request& request, const Output& output, const Control& control) override {
        const std::lock_guard lock(mutex_);
        const auto begin = std::chrono::steady_clock::now();
        const BoxSource source(request.first, request.second, request.options.margin);
        Progress progress(control.progress);
        Call call{request, output, source, {}, progress, {}};
        const std::stop_callback forward(control.stop, [&] { call.stop.request_stop(); });
        build(call);
        if (output.list == nullptr && output.sink == nullptr) {
            count(call);
        } else if (request.options.order == Order::octal) {
            find_octal(call);
        } else {
            find_ascending(call);
        }
        progress.finish();
        call.summary.seconds = seconds_since(begin);
        return call.summary;
    }

    void build(Call& call) {
        call.progress.stage(built, 1);
        TeamExecutor executor(team_);
        try {
            octree_.build(call.source, executor, call.stop.get_token());
        } catch (const LinearOctree::Invalid& invalid) {
            call.source.refuse(invalid.begin);
        }
        call.summary.entries = octree_.entry_count();
        call.summary.steps.encode = octree_.seconds().encode;
        call.summary.steps.merge = octree_.seconds().merge;
        call.summary.steps.sort = octree_.seconds().sort;
    }

    /// One pass over the octree, which takes the progress to `end`.
    void scan_into(Call& call, Executor& executor, double end) {
        const auto begin = std::chrono::steady_clock::now();
        call.progress.stage(end, octree_.entry_count());
        const ScanContext context{call.source, call.stop.get_token()};
        scan(octree_, context, executor, [&](std::uint64_t entries) { call.progress.add(entries); });
        call.summary.steps.scan += seconds_since(begin);
    }

    void count(Call& call) {
        CountExecutor executor(team_);
        scan_into(call, executor, 1);
        const std::uint64_t limit = call.request.options.limit.value_or(~std::uint64_t(0));
        call.summary.pairs = std::min(limit, executor.pairs());
        call.summary.truncated = executor.pairs() > limit;
    }

    void find_octal(Call& call) {
        if (call.output.list != nullptr && !call.request.options.limit) {
            PairList::Storage& list = call.output.list->storage();
            ListExecutor executor(team_, list, ~std::uint64_t(0));
            scan_into(call, executor, 1);
            call.summary.pairs = list.size;
            return;
        }
        Receiver receiver(call.output, call.request.options.limit);
        StreamExecutor executor(
            team_, [&](std::span<const Pair> pairs) { receiver.take(pairs); }, call.buffer_pairs(), call.stop);
        receive(call, receiver, [&] { scan_into(call, executor, 1); });
    }

    void find_ascending(Call& call) {
        Receiver receiver(call.output, call.request.options.limit);
        // Half of the buffer for the pairs as they come, half for their order.
        const std::uint64_t most = call.buffer_pairs() / 2;
        PairList::Storage& found = scratch_.storage();
        found.reset();
        try {
            ListExecutor executor(team_, found, most);
            scan_into(call, executor, 0.9);
        } catch (const ListExecutor::OverBudget&) {
            return find_windows(call, receiver, most);
        }
        hand_out_sorted(call, receiver, {0, call.source.size()});
    }

    /// The pairs in scratch_, all those of `range`, in ascending order to the receiver.
    void hand_out_sorted(Call& call, Receiver& receiver, ObjectRange range) {
        const auto begin = std::chrono::steady_clock::now();
        const bool straight = call.output.list != nullptr && !call.request.options.limit;
        PairList::Storage& sorted = straight ? call.output.list->storage() : sorted_.storage();
        if (!straight) sorted.reset();
        AscendingOrder{team_, call.stop.get_token()}.append(scratch_.storage(), range, sorted);
        call.summary.steps.scan += seconds_since(begin);
        if (straight) {
            call.summary.pairs = sorted.size;
            return;
        }
        receive(call, receiver, [&] {
            for (const auto chunk : sorted.chunks) receiver.take(chunk);
        });
    }

    void find_windows(Call& call, Receiver& receiver, std::uint64_t most) {
        std::vector<std::uint32_t> counts(call.source.size(), 0);
        CountByObjectExecutor counter(team_, counts);
        scan_into(call, counter, 0.5);
        ObjectRange window{0, 0};
        while (window.end < counts.size() && !call.summary.truncated) {
            window.begin = window.end;
            std::uint64_t pairs = 0;
            while (window.end < counts.size() && (pairs == 0 || pairs + counts[window.end] <= most)) {
                pairs += counts[window.end++];
            }
            if (pairs == 0) break;
            scratch_.storage().reset();
            ListExecutor executor(team_, scratch_.storage(), pairs, window);
            scan_into(call, executor, 0.5 + 0.5 * double(window.end) / double(counts.size()));
            hand_out_sorted(call, receiver, window);
        }
    }

    template <typename Give>
    void receive(Call& call, Receiver& receiver, Give&& give) {
        try {
            give();
        } catch (const Receiver::LimitReached&) {
        }
        receiver.flush();
        call.summary.pairs = receiver.pairs();
        call.summary.truncated = receiver.truncated();
    }

    std::mutex mutex_;
    Team team_;
    LinearOctree octree_;
    PairList scratch_;  // pairs before they are put in order, and after
    PairList sorted_;
};

}  // namespace

std::unique_ptr<Engine> make_local_engine(unsigned threads) { return std::make_unique<LocalEngine>(threads); }

}  // namespace octopair
