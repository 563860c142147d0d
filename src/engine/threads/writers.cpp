#include "engine/threads/writers.hpp"

#include <algorithm>

#include "base/test_hooks.hpp"
#include "octopair/error.hpp"

namespace octopair {

namespace {

class CountWriter final : public ShareWriter {
public:
    bool counting() const override { return true; }
    void write(std::span<const Pair> pairs) override { pairs_ += pairs.size(); }
    void write_count(std::uint64_t pairs) override { pairs_ += pairs; }
    std::uint64_t pairs() const { return pairs_; }

private:
    std::uint64_t pairs_ = 0;
};

}  // namespace

void CountByObjectWriter::write(std::span<const Pair> pairs) {
    // Consecutive pairs often have the same `a`: add a run of them with one atomic operation.
    for (std::size_t i = 0; i < pairs.size();) {
        const std::uint32_t a = pairs[i].a;
        std::uint32_t count = 0;
        while (i < pairs.size() && pairs[i].a == a) ++i, ++count;
        std::atomic_ref(counts_[a]).fetch_add(count, std::memory_order_relaxed);
    }
}

void FullWriter::write_count(std::uint64_t) {
    throw Error(ErrorCode::engine_failed, "a step only counted pairs where the pairs themselves are needed");
}

void TeamExecutor::for_each(std::size_t count, const std::function<void(std::size_t)>& body) {
    team_.for_each(count, [&](std::size_t i, unsigned) { body(i); });
}

void TeamExecutor::for_each_writing(std::size_t, const std::function<void(std::size_t, ShareWriter&)>&) {
    throw Error(ErrorCode::engine_failed, "a step without an output for pairs wrote pairs");
}

void CountExecutor::for_each_writing(std::size_t count, const std::function<void(std::size_t, ShareWriter&)>& body) {
    team().for_each(count, [&](std::size_t i, unsigned) {
        CountWriter writer;
        body(i, writer);
        pairs_ += writer.pairs();
    });
}

void CountByObjectExecutor::for_each_writing(std::size_t count,
                                             const std::function<void(std::size_t, ShareWriter&)>& body) {
    team().for_each(count, [&](std::size_t i, unsigned) {
        CountByObjectWriter writer(counts_);
        body(i, writer);
    });
}

/// Writes one share into its thread's block, and into further blocks. Records the runs that it wrote.
class ListExecutor::Writer final : public FullWriter {
public:
    Writer(detail::PairStorage& list, std::span<Pair>& block, std::vector<std::span<const Pair>>& runs)
        : list_(list), block_(block), runs_(runs) {}

    std::span<Pair> room(std::size_t pairs) override {
        if (block_.size() < pairs) {
            if (!block_.empty()) count_path(Path::list_block_full);
            block_ = list_.take_block(pairs);
        }
        return block_.first(pairs);
    }
    void write(std::span<const Pair> pairs) override {
        const std::span<Pair> to = room(pairs.size());
        if (to.data() != pairs.data()) std::copy(pairs.begin(), pairs.end(), to.begin());
        const std::span<const Pair> written = block_.first(pairs.size());
        block_ = block_.subspan(pairs.size());
        if (!runs_.empty() && runs_.back().data() + runs_.back().size() == written.data()) {
            runs_.back() = {runs_.back().data(), runs_.back().size() + written.size()};
        } else {
            runs_.push_back(written);
        }
    }

private:
    detail::PairStorage& list_;
    std::span<Pair>& block_;
    std::vector<std::span<const Pair>>& runs_;
};

ListExecutor::ListExecutor(Team& team, detail::PairStorage& list)
    : TeamExecutor(team), list_(list), blocks_(team.threads()) {}

void ListExecutor::for_each_writing(std::size_t count, const std::function<void(std::size_t, ShareWriter&)>& body) {
    std::vector<std::vector<std::span<const Pair>>> runs(count);
    team().for_each(count, [&](std::size_t i, unsigned worker) {
        Writer writer(list_, blocks_[worker], runs[i]);
        body(i, writer);
    });
    for (const auto& of_share : runs) {
        for (const std::span<const Pair> run : of_share) list_.append(run);
    }
}

}  // namespace octopair
