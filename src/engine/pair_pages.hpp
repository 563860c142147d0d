// Pages of pairs: short pieces of memory that become a list, and strings of them that grow a pair at a time.
#pragma once

#include <algorithm>
#include <cstddef>
#include <span>
#include <utility>
#include <vector>

#include "base/tuning.hpp"
#include "octopair/objects.hpp"

namespace octopair {

/// Pairs of a page.
inline std::size_t page_pairs() { return tuning().output.page; }

/// The pages in one thread's hands: taken fresh, and given back to be taken again.
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
    /// Throws OverBudget (ascending_bounds.hpp).
    virtual Pair* fresh() = 0;

    std::vector<Pair*> returned_;
};

/// Pairs in full pages and a last one.
class PageString {
public:
    PageString() = default;
    /// `size` pairs in pages that have room for them.
    PageString(std::vector<Pair*> pages, std::size_t size) : pages_(std::move(pages)) {
        if (pages_.empty()) return;
        end_ = pages_.back() + page_pairs();
        next_ = end_ - (pages_.size() * page_pairs() - size);
    }

    void add(const Pair& pair, Pages& pages) {
        if (next_ == end_) grow(pages);
        *next_++ = pair;
    }

    std::size_t size() const { return pages_.size() * page_pairs() - std::size_t(end_ - next_); }
    std::span<Pair* const> pages() const { return pages_; }
    std::span<Pair> page(std::size_t i) const { return {pages_[i], std::min(page_pairs(), size() - i * page_pairs())}; }

private:
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
