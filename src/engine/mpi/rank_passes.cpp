#include "engine/mpi/rank_passes.hpp"

#include <algorithm>
#include <array>
#include <utility>

namespace octopair {

/// Passes the pairs of a share to another writer, except pairs that WantedRows excludes. Polls for stop requests of other ranks, because
/// a share may write pairs for minutes.
class RankExecutor::Writer final : public ShareWriter {
public:
    Writer(ShareWriter& writer, RankExecutor& executor) : writer_(writer), executor_(executor) {}

    bool counting() const override { return writer_.counting() && !filters(); }
    std::span<Pair> room(std::size_t pairs) override { return filters() ? std::span<Pair>() : writer_.room(pairs); }
    void write_count(std::uint64_t pairs) override {
        poll_stops();
        writer_.write_count(pairs);
    }
    void write(std::span<const Pair> pairs) override {
        poll_stops();
        if (!filters()) return writer_.write(pairs);
        std::array<Pair, 1024> wanted;
        while (!pairs.empty()) {
            const auto some = pairs.first(std::min(pairs.size(), wanted.size()));
            const std::size_t count = copy_wanted(some, wanted.data());
            if (count > 0) writer_.write(std::span(wanted).first(count));
            pairs = pairs.subspan(some.size());
        }
    }

private:
    bool filters() const { return !executor_.wanted_.marks.empty(); }
    /// Copies the wanted pairs, in order. Returns their number. Requires: `out` has room for all pairs.
    std::size_t copy_wanted(std::span<const Pair> pairs, Pair* out) const {
        const WantedRows& wanted = executor_.wanted_;
        std::size_t count = 0;
        for (const Pair& pair : pairs) {
            out[count] = pair;
            count += wanted.marks[wanted.bins.bin(pair)] != 0 ? 1 : 0;
        }
        return count;
    }
    void poll_stops() {
        if (++writes_ % 64 == 0) executor_.poll_stops();
    }

    ShareWriter& writer_;
    RankExecutor& executor_;
    unsigned writes_ = 0;
};

/// Polls only if this is the thread of the call, because MPI may be limited to one thread.
void RankExecutor::poll_stops() {
    if (std::this_thread::get_id() == thread_) stops_.poll();
}

void RankExecutor::for_each(std::size_t count, const std::function<void(std::size_t)>& body) {
    executor_.for_each(count, [&](std::size_t i) {
        poll_stops();
        body(i);
    });
}

void RankExecutor::for_each_writing(std::size_t count, const std::function<void(std::size_t, ShareWriter&)>& body) {
    executor_.for_each_writing(count, [&](std::size_t i, ShareWriter& writer) {
        poll_stops();
        Writer own(writer, *this);
        body(i, own);
    });
}

RankPasses::RankPasses(unsigned threads)
    : ThreadPasses(threads, [this](const ThreadScan& scan) {
          RankExecutor wanted(scan.executor, *stops_, wanted_);
          scan_octants({scan.call, wanted, scan.progress}, {octree(), share_.begin, share_.end}, searched(scan.call));
      }) {}

void RankPasses::build(Call& call, double progress) {
    TeamExecutor threads(team());
    RankExecutor executor(threads, *stops_);
    positioned_.reset();
    if (share_.positions) positioned_.emplace(call.source, *share_.positions);
    build_octree(call, progress,
                 [&] { octree().build(std::move(share_.layout), searched(call), executor, call.stop.get_token()); });
    call.summary.entries = octree().entry_count(share_.begin, share_.end);
}

/// Returns the source of the octree.
const EntrySource& RankPasses::searched(const Call& call) const {
    if (positioned_) return *positioned_;
    return call.source;
}

void RankPasses::count_rows(Call& call, const RowBins& bins, std::span<std::uint64_t> counts, double progress) {
    count_pairs_by_bin(team(), counts, bins.shift(), scan_into(call, progress));
}

}  // namespace octopair
