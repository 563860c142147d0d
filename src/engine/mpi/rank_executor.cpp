#include "engine/mpi/rank_executor.hpp"

#include <algorithm>
#include <array>

namespace octopair {

/// Renumbers and filters pairs, and passes them to another writer. Polls for stop requests, as a share may write for minutes.
class RankExecutor::Writer final : public ShareWriter {
public:
    Writer(ShareWriter& writer, RankExecutor& executor) : writer_(writer), executor_(executor) {}

    bool counting() const override { return writer_.counting(); }
    void write_count(std::uint64_t pairs) override {
        poll_stops();
        writer_.write_count(pairs);
    }
    void write(std::span<const Pair> pairs) override {
        poll_stops();
        if (executor_.numbers_.a.empty() && executor_.wanted_.marks.empty()) return writer_.write(pairs);
        std::array<Pair, 1024> numbered;
        while (!pairs.empty()) {
            const auto some = pairs.first(std::min(pairs.size(), numbered.size()));
            number(some, numbered);
            const std::size_t wanted = drop_unwanted(std::span(numbered).first(some.size()));
            if (wanted > 0) writer_.write(std::span(numbered).first(wanted));
            pairs = pairs.subspan(some.size());
        }
    }

private:
    void number(std::span<const Pair> pairs, std::span<Pair> out) const {
        const PairNumbers& numbers = executor_.numbers_;
        if (numbers.a.empty()) {
            std::copy(pairs.begin(), pairs.end(), out.begin());
            return;
        }
        for (std::size_t i = 0; i < pairs.size(); ++i) out[i] = {numbers.a[pairs[i].a], numbers.b[pairs[i].b]};
    }
    /// Moves the wanted pairs to the front, in order. Returns their number.
    std::size_t drop_unwanted(std::span<Pair> pairs) const {
        const WantedRows& wanted = executor_.wanted_;
        if (wanted.marks.empty()) return pairs.size();
        std::size_t left = 0;
        for (const Pair& pair : pairs) {
            pairs[left] = pair;
            left += wanted.marks[wanted.bins.bin(pair)] != 0 ? 1 : 0;
        }
        return left;
    }
    void poll_stops() {
        if (++writes_ % 64 == 0) executor_.poll_stops();
    }

    ShareWriter& writer_;
    RankExecutor& executor_;
    unsigned writes_ = 0;
};

/// Polls on the calling thread only, because MPI may be limited to one thread.
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

}  // namespace octopair
