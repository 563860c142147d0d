#include "engine/processes/worker/shared_buckets.hpp"

#include <algorithm>
#include <utility>

#include "engine/threads/writers.hpp"
#include "octopair/error.hpp"

namespace octopair {

namespace {

std::uint64_t page_bytes() { return page_pairs() * sizeof(Pair); }

std::uint64_t pairs_in(std::span<const PageString> strings) {
    std::uint64_t pairs = 0;
    for (const PageString& string : strings) pairs += string.size();
    return pairs;
}

[[noreturn]] void throw_damaged_buckets() {
    throw Error(ErrorCode::engine_failed, "shared memory: the buckets of a worker are damaged");
}

}  // namespace

/// Allocates pages in the region `pairs`. The pass has a budget of pages until set_unlimited() is called for the last step.
class SharedBuckets::RegionPages final : public Pages {
public:
    explicit RegionPages(const OutputPlace& place)
        : place_(place), taken_(place.view.slot(place.shares.slot()).pages_taken) {}

    void set_unlimited() { limited_ = false; }
    /// Sets the number of taken pages to `taken`, the number at the last commit. Gives the pages that a dead worker took after this commit
    /// back to the budget.
    void restore(std::uint64_t taken) {
        place_.view.control_block().pages_left.fetch_add(std::int64_t(taken_.exchange(taken) - taken));
    }
    std::uint64_t taken() const { return taken_.load(); }
    std::uint32_t number(const Pair* page) const {
        return std::uint32_t((reinterpret_cast<const std::byte*>(page) - place_.pairs.data()) / page_bytes());
    }

private:
    Pair* fresh() override {
        if (limited_) {
            taken_.fetch_add(1);
            if (place_.view.control_block().pages_left.fetch_sub(1) <= 0) throw OverBudget{};
        }
        if (block_.empty()) block_ = take_block(place_);
        Pair* const page = block_.data();
        block_ = block_.subspan(page_pairs());
        return page;
    }

    OutputPlace place_;
    std::atomic<std::uint64_t>& taken_;
    std::span<Pair> block_;
    bool limited_ = true;
};

class SharedBuckets::Writer final : public FullWriter {
public:
    Writer(const BucketPlan& plan, Strings& strings, Pages& pages) : plan_(plan), strings_(strings), pages_(pages) {}
    void write(std::span<const Pair> pairs) override { plan_.fill(pairs, strings_, pages_); }

private:
    const BucketPlan& plan_;
    Strings& strings_;
    Pages& pages_;
};

SharedBuckets::SharedBuckets(const OutputPlace& place, const Pass& pass)
    : place_(place),
      workers_(pass.workers),
      plan_(pass.bounds, pass.workers),
      pages_(std::make_unique<RegionPages>(place)),
      strings_(plan_.buckets()),
      logged_(plan_.buckets(), 0),
      writer_(std::make_unique<Writer>(plan_, strings_, *pages_)) {}

SharedBuckets::~SharedBuckets() = default;

ShareWriter& SharedBuckets::begin(const WorkSharing::ClaimedShare&) {
    if (!std::exchange(restored_, true)) restore();
    return *writer_;
}

/// Restores the buckets of this slot from its last commit.
void SharedBuckets::restore() {
    commit_ = last_commit(place_.shares.slot());
    if (commit_ == 0) return pages_->restore(0);
    const Commit& commit = place_.view.commit(place_.shares.slot(), commit_);
    strings_ = committed_strings(place_.shares.slot());
    for (std::size_t bucket = 0; bucket < strings_.size(); ++bucket) logged_[bucket] = strings_[bucket].pages().size();
    log_size_ = commit.log_size;
    pages_->restore(commit.pages_taken);
}

void SharedBuckets::end(const WorkSharing::ClaimedShare& share) {
    std::uint64_t more = 0;
    for (std::size_t bucket = 0; bucket < strings_.size(); ++bucket) {
        more += strings_[bucket].pages().size() - logged_[bucket];
    }
    const auto log = place_.view.log(place_.shares.slot(), log_size_ + more);
    Commit& commit = place_.view.commit(place_.shares.slot(), commit_ + 1);
    for (std::size_t bucket = 0; bucket < strings_.size(); ++bucket) {
        const auto pages = strings_[bucket].pages();
        for (; logged_[bucket] < pages.size(); ++logged_[bucket]) {
            log[log_size_++] = {pages_->number(pages[logged_[bucket]]), std::uint32_t(bucket)};
        }
        commit.sizes[bucket] = strings_[bucket].size();
    }
    commit.log_size = log_size_;
    commit.pages_taken = pages_->taken();
    share.record.commit = ++commit_;
}

/// Returns the number of the slot's last commit that belongs to a finished share of the scan; 0 if there is none.
std::uint64_t SharedBuckets::last_commit(unsigned slot) const {
    std::uint64_t last = 0;
    for (Share& share : place_.view.shares(0, place_.shares.shares())) {
        const ShareState state = ShareState::of(share.state.load());
        if (state.is(place_.shares.pass(), ShareStatus::done) && state.slot == slot &&
            share.step == unsigned(Step::scan)) {
            last = std::max(last, share.commit);
        }
    }
    return last;
}

SharedBuckets::Strings SharedBuckets::committed_strings(unsigned slot) const {
    const std::uint64_t number = last_commit(slot);
    Strings strings(plan_.buckets());
    if (number == 0) return strings;
    const Commit& commit = place_.view.commit(slot, number);
    std::vector<std::vector<Pair*>> pages(plan_.buckets());
    for (const LoggedPage& logged : place_.view.log(slot, commit.log_size)) {
        if (logged.bucket >= pages.size()) throw_damaged_buckets();
        pages[logged.bucket].push_back(place_.pairs.array<Pair>(logged.page * page_bytes(), page_pairs()));
    }
    for (std::size_t bucket = 0; bucket < strings.size(); ++bucket) {
        const std::uint64_t size = commit.sizes[bucket];
        if ((size + page_pairs() - 1) / page_pairs() != pages[bucket].size()) throw_damaged_buckets();
        strings[bucket] = PageString(std::move(pages[bucket]), size);
    }
    return strings;
}

void SharedBuckets::order(WorkSharing& shares) {
    pages_->set_unlimited();
    std::vector<Strings> of_slots;
    of_slots.reserve(workers_);
    for (unsigned slot = 0; slot < workers_; ++slot) of_slots.push_back(committed_strings(slot));
    Slot& own = place_.view.slot(place_.shares.slot());
    std::uint64_t all = 0;
    for (const Strings& of_slot : of_slots) all += pairs_in(of_slot);
    own.pairs_to_order.store(all);
    BucketSort sort(plan_, *pages_);
    std::vector<Pair*> spent;
    shares.run(Step::order, plan_.buckets(), [&](const WorkSharing::ClaimedShare& share) {
        std::vector<PageString> strings;
        strings.reserve(of_slots.size());
        for (Strings& of_slot : of_slots) strings.push_back(std::move(of_slot[share.index]));
        const std::uint64_t pairs = pairs_in(strings);
        // The input pages of the previous share are free now, because that share is done. The input pages of this share must
        // stay unchanged until it is done, in case a replacement worker sorts them again.
        for (Pair* const page : spent) pages_->give_back(page);
        spent.clear();
        record_runs(place_, sort.sort(std::move(strings), place_.stop, &spent), share.record);
        own.pairs_ordered.fetch_add(pairs);
    });
}

}  // namespace octopair
