#include "engine/mpi/rank_executor.hpp"

#include <algorithm>
#include <array>

namespace octopair {

namespace {

/// Numbers pairs on their way to another writer.
class NumberingWriter final : public PairWriter {
public:
    NumberingWriter(PairWriter& writer, const PairNumbers& numbers) : writer_(writer), numbers_(numbers) {}

    bool counting() const override { return writer_.counting(); }
    void write_count(std::uint64_t pairs) override { writer_.write_count(pairs); }
    void write(std::span<const Pair> pairs) override {
        std::array<Pair, 1024> numbered;
        while (!pairs.empty()) {
            const auto some = pairs.first(std::min(pairs.size(), numbered.size()));
            for (std::size_t i = 0; i < some.size(); ++i) {
                numbered[i] = {numbers_.a[some[i].a], numbers_.b[some[i].b]};
            }
            writer_.write(std::span(numbered).first(some.size()));
            pairs = pairs.subspan(some.size());
        }
    }

private:
    PairWriter& writer_;
    const PairNumbers& numbers_;
};

}  // namespace

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
        if (numbers_.a.empty()) return body(i, writer);
        NumberingWriter numbering(writer, numbers_);
        body(i, numbering);
    });
}

}  // namespace octopair
