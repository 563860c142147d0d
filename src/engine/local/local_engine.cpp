// The local engine: the steps of the algorithm on the threads of this process.
//
//   build   the linear octree of all objects, once a call
//   octal   scan once, pairs to a list or to the receiver as they come
//   ascending  scan into buckets and sort them, in the list or, for the receiver, in a buffer. Where the buffer is too
//           small: scan to count each object's pairs, then once for every window of objects whose pairs fit.
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

/// Adds the time of a block to a sum, however the block is left.
class Timed {
public:
    explicit Timed(double& seconds) : seconds_(seconds) {}
    Timed(const Timed&) = delete;
    Timed& operator=(const Timed&) = delete;
    ~Timed() { seconds_ += std::chrono::duration<double>(std::chrono::steady_clock::now() - begin_).count(); }

private:
    double& seconds_;
    std::chrono::steady_clock::time_point begin_ = std::chrono::steady_clock::now();
};

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
        give(held_);
        held_.clear();
    }

    std::uint64_t pairs() const { return pairs_; }
    bool truncated() const { return truncated_; }
    double sink_seconds() const { return sink_seconds_; }

private:
    void deliver(std::span<const Pair> pairs) {
        constexpr std::size_t worth_a_call = 1 << 13;  // pairs; small batches are put together
        if (output_.list != nullptr) return keep(pairs);
        if (held_.size() + pairs.size() > worth_a_call) flush();
        if (pairs.size() >= worth_a_call) {
            give(pairs);
        } else {
            held_.insert(held_.end(), pairs.begin(), pairs.end());
        }
    }

    void give(std::span<const Pair> pairs) {
        const Timed timed(sink_seconds_);
        (*output_.sink)(pairs);
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
    double sink_seconds_ = 0;
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
        const BoxSource source(request.first, request.second, request.options.margin);
        Progress progress(control.progress);
        Call call{request, output, source, {}, progress, {}};
        const std::stop_callback forward(control.stop, [&] { call.stop.request_stop(); });
        search(call);
        progress.finish();
        return call.summary;
    }

    void search(Call& call) {
        const Timed timed(call.summary.seconds);
        build(call);
        if (call.output.list == nullptr && call.output.sink == nullptr) {
            count(call);
        } else if (call.request.options.order == Order::octal) {
            find_octal(call);
        } else {
            find_ascending(call);
        }
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
        const Timed timed(call.summary.steps.scan);
        call.progress.stage(end, octree_.entry_count());
        const ScanContext context{call.source, call.stop.get_token()};
        scan(octree_, context, executor, [&](std::uint64_t entries) { call.progress.add(entries); });
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
            ListExecutor executor(team_, list);
            scan_into(call, executor, 1);
            call.summary.pairs = list.size;
            return;
        }
        Receiver receiver(call.output, call.request.options.limit);
        StreamExecutor executor(
            team_, [&](std::span<const Pair> pairs) { receiver.take(pairs); }, call.buffer_pairs(), call.stop);
        receive(call, receiver, [&] { scan_into(call, executor, 1); });
        call.summary.steps.scan = std::max(0.0, call.summary.steps.scan - receiver.sink_seconds());
    }

    void find_ascending(Call& call) {
        if (call.output.list != nullptr && !call.request.options.limit) {
            PairList::Storage& list = call.output.list->storage();
            collect_ascending(call, list, {{0, call.source.size()}, call.source.size()}, 1);
            call.summary.pairs = list.size;
            return;
        }
        Receiver receiver(call.output, call.request.options.limit);
        const ObjectRange all{0, call.source.size()};
        try {
            collect_ascending(call, held_.storage(), {all, all.end, call.buffer_pairs()}, 0.9);
        } catch (const AscendingExecutor::OverBudget&) {
            return find_windows(call, receiver);
        }
        hand_out_held(call, receiver);
    }

    /// The pairs of some objects to an empty list, in ascending order.
    void collect_ascending(Call& call, PairList::Storage& list, const AscendingExecutor::Bounds& bounds, double end) {
        list.reset();
        AscendingExecutor executor(team_, list, bounds);
        scan_into(call, executor, end);
        const Timed timed(call.summary.steps.scan);
        executor.append_sorted(call.stop.get_token());
    }

    void hand_out_held(Call& call, Receiver& receiver) {
        receive(call, receiver, [&] {
            for (const auto chunk : held_.storage().chunks) receiver.take(chunk);
        });
    }

    /// Where the pairs do not fit into the buffer: counts those of each object, then collects as many objects at a time
    /// as fit.
    void find_windows(Call& call, Receiver& receiver) {
        const std::uint64_t objects = call.source.size();
        std::vector<std::uint32_t> counts(objects, 0);
        CountByObjectExecutor counter(team_, counts);
        scan_into(call, counter, 0.5);
        // A quarter of the buffer is for pages that are not full.
        const std::uint64_t most = call.buffer_pairs() - call.buffer_pairs() / 4;
        ObjectRange window{0, 0};
        while (window.end < objects && !call.summary.truncated) {
            window.begin = window.end;
            std::uint64_t pairs = 0;
            while (window.end < objects && (pairs == 0 || pairs + counts[window.end] <= most)) {
                pairs += counts[window.end++];
            }
            if (pairs == 0) break;
            const double done = 0.5 + 0.5 * double(window.end) / double(objects);
            // One object's pairs have to be held, however many; and each thread has a few pages that are not full.
            const std::uint64_t room = std::max(call.buffer_pairs(), 2 * pairs) + team_.threads() * 2 * page_pairs;
            collect_ascending(call, held_.storage(), {window, objects, room, pairs}, done);
            hand_out_held(call, receiver);
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
    PairList held_;  // ascending pairs on their way to a receiver
};

}  // namespace

std::unique_ptr<Engine> make_local_engine(unsigned threads) { return std::make_unique<LocalEngine>(threads); }

}  // namespace octopair
