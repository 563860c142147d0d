#include "engine/processes/worker/shared_buckets.hpp"

#include <algorithm>
#include <utility>

#include "octopair/error.hpp"

namespace octopair {

namespace {

std::uint64_t page_bytes() { return page_pairs() * sizeof(Pair); }

[[noreturn]] void throw_damaged_buckets() {
    throw Error(ErrorCode::engine_failed, "shared memory: the buckets of a worker are damaged");
}

}  // namespace

SharedBuckets::SharedBuckets(const WorkerPlace& place, const Pass& pass)
    : place_(place),
      workers_(pass.workers),
      plan_(pass.bounds, pass.workers),
      budget_(place.view.control_block().pages_left, place.view.slot(place.shares.slot()).pages_taken),
      pages_([this] { return place_.take_block(page_pairs()); }, budget_),
      logged_(plan_.buckets(), 0) {}

/// Before the first share of this worker: restores the buckets of this slot from its last commit.
void SharedBuckets::restore(Buckets& buckets) {
    if (std::exchange(restored_, true)) return;
    const unsigned slot = place_.shares.slot();
    commit_ = last_commit(slot);
    if (commit_ == 0) return budget_.restore(0);
    const Commit& commit = place_.view.commit(slot, commit_);
    buckets = committed(slot);
    for (std::size_t bucket = 0; bucket < buckets.size(); ++bucket) logged_[bucket] = buckets[bucket].pages().size();
    log_size_ = commit.log_size;
    budget_.restore(commit.pages_taken);
}

void SharedBuckets::commit(const WorkerPlace::Share& share, const Buckets& buckets) {
    place_.shares.reach(CommitPoint::before);
    std::uint64_t more = 0;
    for (std::size_t bucket = 0; bucket < buckets.size(); ++bucket) {
        more += buckets[bucket].pages().size() - logged_[bucket];
    }
    const auto log = place_.view.log(place_.shares.slot(), log_size_ + more);
    Commit& next = place_.view.commit(place_.shares.slot(), commit_ + 1);
    for (std::size_t bucket = 0; bucket < buckets.size(); ++bucket) {
        const auto pages = buckets[bucket].pages();
        for (; logged_[bucket] < pages.size(); ++logged_[bucket]) {
            const auto offset = reinterpret_cast<const std::byte*>(pages[logged_[bucket]]) - place_.pairs.data();
            log[log_size_++] = {std::uint32_t(std::uint64_t(offset) / page_bytes()), std::uint32_t(bucket)};
        }
        next.sizes[bucket] = buckets[bucket].size();
    }
    place_.shares.reach(CommitPoint::within);
    next.log_size = log_size_;
    next.pages_taken = budget_.taken();
    share.record.commit = ++commit_;
}

/// Returns the number of the slot's last commit that belongs to a finished share of the scan; 0 if there is none.
std::uint64_t SharedBuckets::last_commit(unsigned slot) const {
    std::uint64_t last = 0;
    for (Share& share : place_.view.shares(0, place_.shares.shares())) {
        const ShareState state = ShareState::of(share.state.load());
        if (state.is(place_.shares.pass(), ShareStatus::done) && state.slot == slot &&
            share.step.load() == unsigned(Step::scan)) {
            last = std::max(last, share.commit);
        }
    }
    return last;
}

SharedBuckets::Buckets SharedBuckets::committed(unsigned slot) const {
    const std::uint64_t number = last_commit(slot);
    Buckets buckets(plan_.buckets());
    if (number == 0) return buckets;
    const Commit& commit = place_.view.commit(slot, number);
    std::vector<std::vector<Pair*>> pages(plan_.buckets());
    for (const LoggedPage& logged : place_.view.log(slot, commit.log_size)) {
        if (logged.bucket >= pages.size()) throw_damaged_buckets();
        pages[logged.bucket].push_back(place_.pairs.array<Pair>(logged.page * page_bytes(), page_pairs()));
    }
    for (std::size_t bucket = 0; bucket < buckets.size(); ++bucket) {
        const std::uint64_t size = commit.sizes[bucket];
        if ((size + page_pairs() - 1) / page_pairs() != pages[bucket].size()) throw_damaged_buckets();
        buckets[bucket] = PageString(std::move(pages[bucket]), size);
    }
    return buckets;
}

void SharedBuckets::order(WorkSharing& shares) {
    budget_.end();
    std::vector<Buckets> of_slots;
    of_slots.reserve(workers_);
    std::uint64_t all = 0;
    for (unsigned slot = 0; slot < workers_; ++slot) {
        of_slots.push_back(committed(slot));
        all += pairs_in(of_slots.back());
    }
    Slot& own = place_.view.slot(place_.shares.slot());
    own.pairs_to_order.store(all);
    BucketSort sort(plan_, pages_);
    std::vector<Pair*> spent;
    shares.run(Step::order, plan_.buckets(), [&](const WorkerPlace::Share& share) {
        std::vector<PageString> strings = take_bucket(of_slots, share.index);
        const std::uint64_t pairs = pairs_in(strings);
        // The input pages of the previous share are free now, because that share is done. The input pages of this share must
        // stay unchanged until it is done, in case a replacement worker sorts them again.
        for (Pair* const page : spent) pages_.give_back(page);
        spent.clear();
        PairRuns sorted;
        for (const auto run : sort.sort(std::move(strings), place_.stop, &spent)) sorted.add(run);
        place_.record(share, sorted);
        own.pairs_ordered.fetch_add(pairs);
    });
}

}  // namespace octopair
