// Pages of pairs: short pieces of a list's memory, and strings of them that grow a pair at a time.
#pragma once

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "engine/pair_list.hpp"

namespace octopair {

constexpr std::size_t page_pairs = 512;

/// The pages in one thread's hands: taken from the list, and given back to be taken again.
class Pages {
public:
    struct OverBudget {};

    /// `left` is how many pages all threads together may still take from the list.
    Pages(PairList::Storage& list, std::atomic<std::int64_t>& left) : list_(list), left_(left) {}

    Pair* take() {
        if (returned_.empty()) return fresh();
        Pair* page = returned_.back();
        returned_.pop_back();
        return page;
    }
    void give_back(Pair* page) { returned_.push_back(page); }

private:
    Pair* fresh() {
        constexpr std::size_t pages_at_once = 64;  // a whole block
        if (--left_ < 0) throw OverBudget{};
        if (block_.empty()) block_ = list_.take_block(pages_at_once * page_pairs).first(pages_at_once * page_pairs);
        Pair* page = block_.data();
        block_ = block_.subspan(page_pairs);
        return page;
    }

    PairList::Storage& list_;
    std::atomic<std::int64_t>& left_;
    std::span<Pair> block_;
    std::vector<Pair*> returned_;
};

/// Pairs in full pages and a last one.
class PageString {
public:
    void add(const Pair& pair, Pages& pages) {
        if (next_ == end_) grow(pages);
        *next_++ = pair;
    }

    std::size_t size() const { return pages_.size() * page_pairs - std::size_t(end_ - next_); }
    std::span<Pair* const> pages() const { return pages_; }
    std::span<Pair> page(std::size_t i) const { return {pages_[i], std::min(page_pairs, size() - i * page_pairs)}; }

private:
    void grow(Pages& pages) {
        next_ = pages.take();
        end_ = next_ + page_pairs;
        pages_.push_back(next_);
    }

    std::vector<Pair*> pages_;
    Pair* next_ = nullptr;
    Pair* end_ = nullptr;
};

}  // namespace octopair
