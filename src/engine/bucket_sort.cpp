#include "engine/bucket_sort.hpp"

#include <array>
#include <utility>

#include "base/stop.hpp"
#include "base/test_hooks.hpp"
#include "base/tuning.hpp"

namespace octopair {

namespace {

std::size_t size_of(const std::vector<PageString>& strings) {
    std::size_t size = 0;
    for (const PageString& string : strings) size += string.size();
    return size;
}

}  // namespace

BucketPlan::BucketPlan(const AscendingBounds& bounds, unsigned fillers) : keys_(bounds.rows, bounds.columns) {
    const std::uint64_t spare_pages = bounds.max_pairs / page_pairs() / 4 / fillers;
    const unsigned row_bits = keys_.row_bits();
    const unsigned for_rows = row_bits - std::min(row_bits, tuning().output.bucket_row_bits);
    const unsigned for_pairs =
        std::min(row_bits, unsigned(std::bit_width(bounds.expected / tuning().output.sorted_at_once * 2)));
    const unsigned wanted = std::min(std::max(for_rows, for_pairs), tuning().output.bucket_bits);
    bits_ = std::clamp(wanted, 1u, unsigned(std::bit_width(spare_pages | 2)) - 1);
}

struct BucketSort::Task {
    const std::stop_token& stop;
    Pages& pages;
    std::vector<Pair*>* spent;
    Runs sorted = {};

    void spend(Pair* page) { spent != nullptr ? spent->push_back(page) : pages.give_back(page); }
};

BucketSort::Runs BucketSort::sort(std::vector<PageString>&& strings, const std::stop_token& stop,
                                  std::vector<Pair*>* spent) {
    Task task{stop, pages_, spent};
    sort(std::move(strings), plan_.key_bits(), task);
    return std::move(task.sorted);
}

/// Requires: the keys of all pairs differ only in their lowest `bits`.
void BucketSort::sort(std::vector<PageString>&& strings, unsigned bits, Task& task) {
    const std::size_t size = size_of(strings);
    if (size == 0) return;
    throw_if_stopped(task.stop);
    if (size > tuning().output.sorted_at_once && bits > 0) {
        count_path(Path::bucket_split);
        return split(std::move(strings), bits, task);
    }
    count_path(Path::bucket_sorted);
    count_path(bits <= 32 ? Path::keys_narrow : Path::keys_wide);
    if (bits <= 32) return sort_at_once(strings, bits, narrow_, task);
    sort_at_once(strings, bits, wide_, task);
}

void BucketSort::split(std::vector<PageString>&& strings, unsigned bits, Task& task) {
    const unsigned low_bits = bits - std::min(bits, tuning().output.bucket_split_bits);
    std::vector<PageString> parts(std::size_t(1) << tuning().output.bucket_split_bits);
    for (const PageString& string : strings) {
        for (std::size_t i = 0; i < string.pages().size(); ++i) {
            throw_if_stopped(task.stop);
            for (const Pair& pair : string.page(i)) {
                parts[plan_.keys().key(pair) >> low_bits & (parts.size() - 1)].add(pair, pages_);
            }
            task.spend(string.pages()[i]);
        }
    }
    strings.clear();
    for (PageString& part : parts) {
        std::vector<PageString> one;
        one.push_back(std::move(part));
        sort(std::move(one), low_bits, task);
    }
}

template <typename Key>
void BucketSort::sort_at_once(const std::vector<PageString>& strings, unsigned bits, RadixSort<Key>& radix,
                              Task& task) {
    constexpr unsigned key_bits = sizeof(Key) * 8;
    const std::span<Key> keys = radix.take(size_of(strings));
    std::uint64_t above = 0;  // the high bits, equal in all keys
    std::size_t at = 0;
    for (const PageString& string : strings) {
        for (std::size_t i = string.pages().size(); i-- > 0;) {  // the page returned last is taken first
            for (const Pair& pair : string.page(i)) keys[at++] = Key(above = plan_.keys().key(pair));
            task.spend(string.pages()[i]);
        }
    }
    above = above >> (key_bits - 1) >> 1 << (key_bits - 1) << 1;
    std::span<const Key> sorted = radix.sort(0, bits);
    while (!sorted.empty()) {
        Pair* const page = pages_.take();
        const auto part = sorted.first(std::min(sorted.size(), page_pairs()));
        for (std::size_t i = 0; i < part.size(); ++i) page[i] = plan_.keys().pair(above | part[i]);
        task.sorted.emplace_back(page, part.size());
        sorted = sorted.subspan(part.size());
    }
}

}  // namespace octopair
