#include "engine/threads/ascending.hpp"

#include <atomic>
#include <limits>
#include <utility>
#include <vector>

#include "engine/bucket_sort.hpp"

namespace octopair {

namespace {

/// Allocates pages from the blocks of a list.
class ListPages final : public Pages {
public:
    /// `left`: number of pages that all threads together may still take from the list.
    ListPages(detail::PairStorage& list, std::atomic<std::int64_t>& left) : list_(list), left_(left) {}

private:
    Pair* fresh() override {
        constexpr std::size_t pages_at_once = 64;  // minimum number of pages of a block
        if (--left_ < 0) throw OverBudget{};
        if (block_.size() < page_pairs()) block_ = list_.take_block(pages_at_once * page_pairs());
        Pair* page = block_.data();
        block_ = block_.subspan(page_pairs());
        return page;
    }

    detail::PairStorage& list_;
    std::atomic<std::int64_t>& left_;
    std::span<Pair> block_;
};

/// State of one thread.
struct Worker {
    Worker(const BucketPlan& plan, detail::PairStorage& list, std::atomic<std::int64_t>& pages_left)
        : pages(list, pages_left), found(plan.buckets()), sort(plan, pages) {}

    ListPages pages;
    std::vector<PageString> found;  // the pairs of each bucket
    BucketSort sort;
};

/// Scatters pairs into the buckets of one thread.
class BucketWriter final : public FullWriter {
public:
    BucketWriter(const BucketPlan& plan, Worker& worker) : plan_(plan), worker_(worker) {}
    void write(std::span<const Pair> pairs) override { plan_.fill(pairs, worker_.found, worker_.pages); }

private:
    const BucketPlan& plan_;
    Worker& worker_;
};

}  // namespace

class AscendingExecutor::Buckets {
public:
    Buckets(unsigned threads, detail::PairStorage& list, const AscendingBounds& bounds)
        : list_(list), plan_(bounds, threads), pages_left_(std::int64_t(bounds.max_pairs / page_pairs())) {
        for (unsigned i = 0; i < threads; ++i) workers_.push_back(std::make_unique<Worker>(plan_, list, pages_left_));
    }

    BucketWriter writer(unsigned worker) { return {plan_, *workers_[worker]}; }

    std::uint64_t pairs() const {
        std::uint64_t all = 0;
        for (const auto& worker : workers_) {
            for (const PageString& found : worker->found) all += found.size();
        }
        return all;
    }

    void append_sorted(Team& team, const std::stop_token& stop, const OnSorted& on_sorted) {
        pages_left_ = std::numeric_limits<std::int64_t>::max();  // no limit: splitting a bucket takes more pages
        std::vector<BucketSort::Runs> sorted(plan_.buckets());
        team.for_each(sorted.size(), [&](std::size_t bucket, unsigned worker) {
            std::vector<PageString> strings;
            strings.reserve(workers_.size());
            std::uint64_t pairs = 0;
            for (const auto& other : workers_) {
                pairs += other->found[bucket].size();
                strings.push_back(std::exchange(other->found[bucket], {}));
            }
            sorted[bucket] = workers_[worker]->sort.sort(std::move(strings), stop);
            if (on_sorted) on_sorted(pairs);
        });
        for (const auto& runs : sorted) {
            for (const auto run : runs) list_.append(run);
        }
    }

private:
    detail::PairStorage& list_;
    const BucketPlan plan_;
    std::atomic<std::int64_t> pages_left_;
    std::vector<std::unique_ptr<Worker>> workers_;
};

AscendingExecutor::AscendingExecutor(Team& team, detail::PairStorage& list, const AscendingBounds& bounds)
    : TeamExecutor(team), buckets_(std::make_unique<Buckets>(team.threads(), list, bounds)) {}

AscendingExecutor::~AscendingExecutor() = default;

void AscendingExecutor::for_each_writing(std::size_t count,
                                         const std::function<void(std::size_t, ShareWriter&)>& body) {
    team().for_each(count, [&](std::size_t i, unsigned worker) {
        BucketWriter writer = buckets_->writer(worker);
        body(i, writer);
    });
}

std::uint64_t AscendingExecutor::pairs() const { return buckets_->pairs(); }

void AscendingExecutor::append_sorted(const std::stop_token& stop, const OnSorted& on_sorted) {
    buckets_->append_sorted(team(), stop, on_sorted);
}

}  // namespace octopair
