#include "engine/local/writers.hpp"

#include <algorithm>
#include <array>
#include <utility>

#include "octopair/error.hpp"

namespace octopair {

namespace {

class CountWriter final : public PairWriter {
public:
    bool counting() const override { return true; }
    void write(std::span<const Pair> pairs) override { pairs_ += pairs.size(); }
    void write_count(std::uint64_t pairs) override { pairs_ += pairs; }
    std::uint64_t pairs() const { return pairs_; }

private:
    std::uint64_t pairs_ = 0;
};

class CountByObjectWriter final : public FullWriter {
public:
    explicit CountByObjectWriter(std::span<std::uint32_t> counts) : counts_(counts) {}
    void write(std::span<const Pair> pairs) override {
        for (const Pair& pair : pairs) {
            std::atomic_ref(counts_[pair.a]).fetch_add(1, std::memory_order_relaxed);
        }
    }

private:
    std::span<std::uint32_t> counts_;
};

}  // namespace

void FullWriter::write_count(std::uint64_t) {
    throw Error(ErrorCode::engine_failed, "pairs counted where they are wanted");
}

void TeamExecutor::for_each(std::size_t count, const std::function<void(std::size_t)>& body) {
    team_.for_each(count, [&](std::size_t i, unsigned) { body(i); });
}

void TeamExecutor::for_each_writing(std::size_t, const std::function<void(std::size_t, PairWriter&)>&) {
    throw Error(ErrorCode::engine_failed, "a step that writes no pairs wrote some");
}

void CountExecutor::for_each_writing(std::size_t count, const std::function<void(std::size_t, PairWriter&)>& body) {
    team().for_each(count, [&](std::size_t i, unsigned) {
        CountWriter writer;
        body(i, writer);
        pairs_ += writer.pairs();
    });
}

void CountByObjectExecutor::for_each_writing(std::size_t count,
                                             const std::function<void(std::size_t, PairWriter&)>& body) {
    team().for_each(count, [&](std::size_t i, unsigned) {
        CountByObjectWriter writer(counts_);
        body(i, writer);
    });
}

/// Writes one share into its worker's block, and into further ones; remembers the runs that it wrote.
class ListExecutor::Writer final : public FullWriter {
public:
    Writer(ListExecutor& owner, Worker& worker, std::vector<std::span<const Pair>>& runs)
        : owner_(owner), worker_(worker), runs_(runs) {}

    void write(std::span<const Pair> pairs) override {
        const ObjectRange range = owner_.range_;
        if (range.begin == 0 && range.end == ~std::uint64_t(0)) return put(pairs);
        std::array<Pair, 256> kept;
        std::size_t count = 0;
        for (const Pair& pair : pairs) {
            kept[count] = pair;
            count += (pair.a >= range.begin && pair.a < range.end) ? 1 : 0;
            if (count == kept.size()) put(std::span(kept).first(std::exchange(count, 0)));
        }
        put(std::span(kept).first(count));
    }

private:
    void put(std::span<const Pair> pairs) {
        if (pairs.empty()) return;
        const std::uint64_t written_so_far = owner_.written_ += pairs.size();
        if (written_so_far > owner_.most_) throw OverBudget{};
        if (worker_.block.size() < pairs.size()) worker_.block = owner_.list_.take_block(pairs.size());
        std::copy(pairs.begin(), pairs.end(), worker_.block.begin());
        const std::span<const Pair> written = worker_.block.first(pairs.size());
        worker_.block = worker_.block.subspan(pairs.size());
        if (!runs_.empty() && runs_.back().data() + runs_.back().size() == written.data()) {
            runs_.back() = {runs_.back().data(), runs_.back().size() + written.size()};
        } else {
            runs_.push_back(written);
        }
    }

    ListExecutor& owner_;
    Worker& worker_;
    std::vector<std::span<const Pair>>& runs_;
};

ListExecutor::ListExecutor(Team& team, PairList::Storage& list, std::uint64_t most, ObjectRange range)
    : TeamExecutor(team), list_(list), most_(most), range_(range), workers_(team.threads()) {}

void ListExecutor::for_each_writing(std::size_t count, const std::function<void(std::size_t, PairWriter&)>& body) {
    std::vector<std::vector<std::span<const Pair>>> runs(count);
    team().for_each(count, [&](std::size_t i, unsigned worker) {
        Writer writer(*this, workers_[worker], runs[i]);
        body(i, writer);
    });
    for (const auto& of_share : runs) {
        for (const std::span<const Pair> run : of_share) list_.append(run);
    }
}

}  // namespace octopair
