// Pages of pairs: arrays of pairs that grow by pages of a fixed size, and the budget of the pages that a pass may take.
#pragma once

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <utility>
#include <vector>

#include "base/memory.hpp"
#include "base/tuning.hpp"
#include "octopair/objects.hpp"

namespace octopair {

/// Returns the capacity of a page in pairs.
inline std::size_t page_pairs() { return tuning().output.page; }

/// Thrown by a pass that needs more pages than its budget allows. At most a quarter of its pages are then partly filled,
/// if each thread or worker may take at least 8 pages. Also thrown if a list may need more memory than is free (engine/pair_room.hpp).
struct OverBudget {};

/// Number of pages that all threads or workers of a pass together may still take. Also counts the pages that one thread or worker took.
/// Thread safety: any thread.
class PageBudget {
public:
    /// Borrows both numbers, which may be in shared memory.
    PageBudget(std::atomic<std::int64_t>& left, std::atomic<std::uint64_t>& taken) : left_(&left), taken_(&taken) {}

    /// Throws: OverBudget.
    void take_page() {
        if (ended_) return;
        taken_->fetch_add(1);
        if (left_->fetch_sub(1) <= 0) throw OverBudget{};
    }
    std::uint64_t taken() const { return taken_->load(); }
    /// Sets the number of pages that were taken, and adds the difference to the pages that are left.
    void restore(std::uint64_t taken) { left_->fetch_add(std::int64_t(taken_->exchange(taken) - taken)); }
    /// From now on, pages are not limited: sorting a bucket takes more pages than it returns, if the bucket is split.
    void end() { ended_ = true; }

private:
    std::atomic<std::int64_t>* left_;
    std::atomic<std::uint64_t>* taken_;
    bool ended_ = false;
};

/// Page allocator of one thread or worker, with a free list.
class Pages {
public:
    /// `next_block` returns memory for at least one page. Borrows the budget.
    Pages(std::function<std::span<Pair>()> next_block, PageBudget& budget)
        : next_block_(std::move(next_block)), budget_(budget) {}

    /// Throws: OverBudget.
    Pair* take() {
        if (returned_.empty()) return fresh();
        Pair* page = returned_.back();
        returned_.pop_back();
        return page;
    }
    void give_back(Pair* page) { returned_.push_back(page); }

private:
    Pair* fresh() {
        budget_.take_page();
        if (block_.size() < page_pairs()) block_ = next_block_();
        Pair* const page = block_.data();
        block_ = block_.subspan(page_pairs());
        return page;
    }

    std::function<std::span<Pair>()> next_block_;
    PageBudget& budget_;
    std::span<Pair> block_;
    std::vector<Pair*> returned_;
};

/// A growing array of pairs in pages. All pages but the last are full.
class PageString {
public:
    PageString() = default;
    /// Requires: `pages` is exactly as long as `size` pairs need.
    PageString(std::vector<Pair*> pages, std::size_t size) : pages_(std::move(pages)) {
        if (pages_.empty()) return;
        end_ = pages_.back() + page_pairs();
        next_ = end_ - (pages_.size() * page_pairs() - size);
    }

    void add(const Pair& pair, Pages& pages) {
        if (next_ == end_) grow(pages);
        prefetch(next_ + prefetched);
        *next_++ = pair;
    }

    std::size_t size() const { return pages_.size() * page_pairs() - std::size_t(end_ - next_); }
    std::span<Pair* const> pages() const { return pages_; }
    std::span<Pair> page(std::size_t i) const { return {pages_[i], std::min(page_pairs(), size() - i * page_pairs())}; }

private:
    static constexpr std::size_t prefetched = 12;  // pairs: the cache line after the current one

    void grow(Pages& pages) {
        next_ = pages.take();
        end_ = next_ + page_pairs();
        pages_.push_back(next_);
    }

    std::vector<Pair*> pages_;
    Pair* next_ = nullptr;
    Pair* end_ = nullptr;
};

/// Returns the number of pairs in all strings.
inline std::uint64_t pairs_in(std::span<const PageString> strings) {
    std::uint64_t pairs = 0;
    for (const PageString& string : strings) pairs += string.size();
    return pairs;
}

/// Writes pairs to pages, and appends a run for each page.
class PageWriter {
public:
    using Runs = std::vector<std::span<const Pair>>;
    PageWriter(Pages& pages, Runs& runs) : pages_(pages), runs_(runs) {}
    /// Returns the number of pairs that fit into the page, at least 1. Takes a page if there is none.
    std::size_t left() {
        if (page_ == nullptr) page_ = pages_.take();
        return page_pairs() - used_;
    }
    /// Requires: left() was called since the last pairs were written.
    Pair* next() { return page_ + used_; }
    /// Counts pairs that the caller stored at next().
    void wrote(std::size_t pairs) {
        used_ += pairs;
        if (used_ == page_pairs()) finish();
    }
    /// Writes copies of pairs, of any number.
    void copy(std::span<const Pair> pairs) {
        while (!pairs.empty()) {
            const auto part = pairs.first(std::min(pairs.size(), left()));
            std::ranges::copy(part, next());
            wrote(part.size());
            pairs = pairs.subspan(part.size());
        }
    }
    /// Appends the run of the current page, which may not be full. Must be called after the last pairs are written.
    void finish() {
        if (used_ > 0) runs_.emplace_back(page_, used_);
        page_ = nullptr;
        used_ = 0;
    }

private:
    Pages& pages_;
    Runs& runs_;
    Pair* page_ = nullptr;
    std::size_t used_ = 0;
};

}  // namespace octopair
