#include "engine/mpi/rank_executor.hpp"

#include <algorithm>
#include <array>

namespace octopair {

/// On the way to another writer. A share may write for minutes: it looks out as well.
class RankExecutor::Writer final : public PairWriter {
public:
    Writer(PairWriter& writer, RankExecutor& executor) : writer_(writer), executor_(executor) {}

    bool counting() const override { return writer_.counting(); }
    void write_count(std::uint64_t pairs) override {
        look_out();
        writer_.write_count(pairs);
    }
    void write(std::span<const Pair> pairs) override {
        look_out();
        const PairNumbers& numbers = executor_.numbers_;
        if (numbers.a.empty()) return writer_.write(pairs);
        std::array<Pair, 1024> numbered;
        while (!pairs.empty()) {
            const auto some = pairs.first(std::min(pairs.size(), numbered.size()));
            for (std::size_t i = 0; i < some.size(); ++i) {
                numbered[i] = {numbers.a[some[i].a], numbers.b[some[i].b]};
            }
            writer_.write(std::span(numbered).first(some.size()));
            pairs = pairs.subspan(some.size());
        }
    }

private:
    void look_out() {
        if (++writes_ % 64 == 0) executor_.look_out();
    }

    PairWriter& writer_;
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

void RankExecutor::for_each_writing(std::size_t count, const std::function<void(std::size_t, PairWriter&)>& body) {
    executor_.for_each_writing(count, [&](std::size_t i, PairWriter& writer) {
        look_out();
        Writer own(writer, *this);
        body(i, own);
    });
}

}  // namespace octopair
