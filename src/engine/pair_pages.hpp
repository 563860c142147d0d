// Pages: fixed-size arrays of pairs, which later form a list. PageString: an array of pairs that grows page by page.
#pragma once

#include <algorithm>
#include <cstddef>
#include <span>
#include <utility>
#include <vector>

#include "base/memory.hpp"
#include "base/tuning.hpp"
#include "octopair/objects.hpp"

namespace octopair {

/// Returns the capacity of a page in pairs.
inline std::size_t page_pairs() { return tuning().output.page; }

/// Page allocator of one thread, with a free list.
class Pages {
public:
    virtual ~Pages() = default;

    Pair* take() {
        if (returned_.empty()) return fresh();
        Pair* page = returned_.back();
        returned_.pop_back();
        return page;
    }
    void give_back(Pair* page) { returned_.push_back(page); }

private:
    /// Returns a new page. Throws: OverBudget (bucket_sort.hpp).
    virtual Pair* fresh() = 0;

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

}  // namespace octopair
