#include "engine/mpi/rank_passes.hpp"

#include <algorithm>
#include <array>
#include <utility>

namespace octopair {

/// Passes the pairs of a share to another writer, as PairNaming says. Polls for stop requests of other ranks, because a share may write
/// pairs for minutes.
class RankExecutor::Writer final : public ShareWriter {
public:
    Writer(ShareWriter& writer, RankExecutor& executor) : writer_(writer), executor_(executor) {}

    bool counting() const override { return writer_.counting() && !filters(); }
    std::span<Pair> room(std::size_t pairs) override {
        room_ = filters() ? std::span<Pair>() : writer_.room(pairs);
        return room_;
    }
    void write_count(std::uint64_t pairs) override {
        poll_stops();
        writer_.write_count(pairs);
    }
    void write(std::span<const Pair> pairs) override {
        poll_stops();
        if (!names() && !filters()) return writer_.write(pairs);
        if (!filters() && pairs.data() == room_.data()) {
            for (Pair& pair : room_.first(pairs.size())) pair = named(pair);
            return writer_.write(pairs);
        }
        std::array<Pair, 1024> written;
        while (!pairs.empty()) {
            const auto some = pairs.first(std::min(pairs.size(), written.size()));
            const std::size_t count = copy_wanted(some, written.data());
            if (count > 0) writer_.write(std::span(written).first(count));
            pairs = pairs.subspan(some.size());
        }
    }

private:
    bool filters() const { return !executor_.naming_.wanted.marks.empty(); }
    bool names() const { return !executor_.naming_.positions[0].empty(); }
    Pair named(const Pair& pair) const {
        const auto& [of_first, of_second] = executor_.naming_.positions;
        return {of_first[pair.a], executor_.naming_.join ? of_second[pair.b] : of_first[pair.b]};
    }
    /// Copies the wanted pairs, in order. Returns their number. Requires: `out` has room for all pairs.
    std::size_t copy_wanted(std::span<const Pair> pairs, Pair* out) const {
        const WantedRows& wanted = executor_.naming_.wanted;
        std::size_t count = 0;
        for (const Pair& pair : pairs) {
            out[count] = names() ? named(pair) : pair;
            count += !filters() || wanted.marks[wanted.bins.bin(out[count])] != 0 ? 1 : 0;
        }
        return count;
    }
    void poll_stops() {
        if (++writes_ % 64 == 0) executor_.poll_stops();
    }

    ShareWriter& writer_;
    RankExecutor& executor_;
    std::span<Pair> room_;
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
          const EntrySource& source = searched(scan.call);
          RankExecutor named(scan.executor, *stops_, {source.join(), share_.positions, wanted_});
          scan_octants({scan.call, named, scan.progress, scan.stop}, {octree(), share_.begin, share_.end}, source);
      }) {}

void RankPasses::build(Call& call, double progress) {
    build_octree(call, progress, [&] {
        if (!share_.layout) return;
        TeamExecutor threads(team());
        RankExecutor executor(threads, *stops_);
        octree().build(std::move(*share_.layout), searched(call), executor, call.stop.get_token());
        share_.layout.reset();
    });
    call.summary.entries = octree().entry_count(share_.begin, share_.end);
}

void RankPasses::count_rows(Call& call, const RowBins& bins, std::span<std::uint64_t> counts, double progress) {
    count_pairs_by_bin(team(), counts, bins.shift(), scan_into(call, progress));
}

}  // namespace octopair
