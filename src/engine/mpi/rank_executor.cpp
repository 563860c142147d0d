#include "engine/mpi/rank_executor.hpp"

#include <algorithm>
#include <array>

namespace octopair {

/// On the way to another writer. A share may write for minutes: it looks out as well.
class RankExecutor::Writer final : public ShareWriter {
public:
    Writer(ShareWriter& writer, RankExecutor& executor) : writer_(writer), executor_(executor) {}

    bool counting() const override { return writer_.counting(); }
    void write_count(std::uint64_t pairs) override {
        look_out();
        writer_.write_count(pairs);
    }
    void write(std::span<const Pair> pairs) override {
        look_out();
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
    /// Returns how many are left, at the front.
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
    void look_out() {
        if (++writes_ % 64 == 0) executor_.look_out();
    }

    ShareWriter& writer_;
    RankExecutor& executor_;
    unsigned writes_ = 0;
};

/// MPI may have been started for one thread alone.
void RankExecutor::look_out() {
    if (std::this_thread::get_id() == thread_) stops_.pass_on();
}

void RankExecutor::for_each(std::size_t count, const std::function<void(std::size_t)>& body) {
    executor_.for_each(count, [&](std::size_t i) {
        look_out();
        body(i);
    });
}

void RankExecutor::for_each_writing(std::size_t count, const std::function<void(std::size_t, ShareWriter&)>& body) {
    executor_.for_each_writing(count, [&](std::size_t i, ShareWriter& writer) {
        look_out();
        Writer own(writer, *this);
        body(i, own);
    });
}

}  // namespace octopair
