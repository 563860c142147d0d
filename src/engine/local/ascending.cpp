#include "engine/local/ascending.hpp"

#include <array>
#include <atomic>
#include <bit>
#include <limits>
#include <utility>
#include <vector>

#include "base/radix_sort.hpp"
#include "base/stop.hpp"
#include "engine/local/pair_pages.hpp"

namespace octopair {

namespace {

constexpr unsigned most_bucket_bits = 10;
constexpr unsigned objects_a_bucket_bits = 12;   // unless that makes too many buckets
constexpr unsigned split_bits = 6;               // of a bucket too large to be sorted at once
constexpr std::size_t sorted_at_once = 1 << 18;  // pairs

/// Pairs as numbers in the same order, of as few bits as the rows and columns need.
class PairKeys {
public:
    PairKeys(ObjectRange rows, std::uint64_t columns)
        : first_(rows.begin), count_(rows.end - rows.begin), b_bits_(unsigned(std::bit_width(columns))) {}

    bool wanted(const Pair& pair) const { return pair.a - first_ < count_; }
    std::uint64_t key(const Pair& pair) const { return (pair.a - first_) << b_bits_ | pair.b; }
    Pair pair(std::uint64_t key) const {
        return {std::uint32_t((key >> b_bits_) + first_), std::uint32_t(key & ((std::uint64_t(1) << b_bits_) - 1))};
    }
    unsigned row_bits() const { return std::max(1u, unsigned(std::bit_width(count_))); }
    unsigned bits() const { return row_bits() + b_bits_; }

private:
    std::uint64_t first_, count_;
    unsigned b_bits_;
};

/// What one thread needs.
struct Worker {
    Worker(PairList::Storage& list, std::atomic<std::int64_t>& pages_left) : pages(list, pages_left) {}

    Pages pages;
    std::vector<PageString> found;  // by bucket
    RadixSort<std::uint32_t> narrow;
    RadixSort<std::uint64_t> wide;
};

using Runs = std::vector<std::span<const Pair>>;

/// Puts the pairs of one bucket in order. One thread at a time.
class BucketSort {
public:
    BucketSort(const PairKeys& keys, Worker& worker, const std::stop_token& stop, Runs& sorted)
        : keys_(keys), worker_(worker), stop_(stop), sorted_(sorted) {}

    /// The keys of the pairs differ in their lowest `bits` alone.
    void sort(std::vector<PageString>&& strings, unsigned bits) {
        std::size_t size = 0;
        for (const PageString& string : strings) size += string.size();
        if (size == 0) return;
        throw_if_stopped(stop_);
        if (size > sorted_at_once && bits > 0) return split(std::move(strings), bits);
        if (bits <= 32) return sort_at_once(strings, size, bits, worker_.narrow);
        sort_at_once(strings, size, bits, worker_.wide);
    }

private:
    void split(std::vector<PageString>&& strings, unsigned bits) {
        const unsigned low_bits = bits - std::min(bits, split_bits);
        std::array<PageString, 1u << split_bits> parts;
        for (const PageString& string : strings) {
            for (std::size_t i = 0; i < string.pages().size(); ++i) {
                throw_if_stopped(stop_);
                for (const Pair& pair : string.page(i)) {
                    parts[keys_.key(pair) >> low_bits & (parts.size() - 1)].add(pair, worker_.pages);
                }
                worker_.pages.give_back(string.pages()[i]);
            }
        }
        strings.clear();
        for (PageString& part : parts) {
            std::vector<PageString> one;
            one.push_back(std::move(part));
            sort(std::move(one), low_bits);
        }
    }

    template <typename Key>
    void sort_at_once(const std::vector<PageString>& strings, std::size_t size, unsigned bits, RadixSort<Key>& radix) {
        const std::span<Key> keys = radix.take(size);
        std::size_t at = 0;
        std::vector<Pair*> pages;
        for (const PageString& string : strings) {
            for (std::size_t i = 0; i < string.pages().size(); ++i) {
                for (const Pair& pair : string.page(i)) keys[at++] = Key(keys_.key(pair));
                pages.push_back(string.pages()[i]);
            }
        }
        const std::uint64_t above = keys_.key(*pages[0]) >> (sizeof(Key) * 8 - 1) >> 1 << (sizeof(Key) * 8 - 1) << 1;
        write(radix.sort(0, bits), above, pages);
    }

    /// Back over the pages that they came from; what remains free is given back.
    template <typename Key>
    void write(std::span<const Key> keys, std::uint64_t above, const std::vector<Pair*>& pages) {
        for (Pair* const page : pages) {
            const auto part = keys.first(std::min(keys.size(), page_pairs));
            for (std::size_t i = 0; i < part.size(); ++i) page[i] = keys_.pair(above | part[i]);
            if (part.empty())
                worker_.pages.give_back(page);
            else
                sorted_.emplace_back(page, part.size());
            keys = keys.subspan(part.size());
        }
    }

    const PairKeys& keys_;
    Worker& worker_;
    const std::stop_token& stop_;
    Runs& sorted_;
};

/// Throws pairs into one thread's buckets.
class BucketWriter final : public FullWriter {
public:
    BucketWriter(const PairKeys& keys, unsigned shift, Worker& worker) : keys_(keys), shift_(shift), worker_(worker) {}

    void write(std::span<const Pair> pairs) override {
        for (const Pair& pair : pairs) {
            if (keys_.wanted(pair)) worker_.found[keys_.key(pair) >> shift_].add(pair, worker_.pages);
        }
    }

private:
    const PairKeys& keys_;
    const unsigned shift_;
    Worker& worker_;
};

}  // namespace

class AscendingExecutor::Buckets {
public:
    Buckets(unsigned threads, PairList::Storage& list, const Bounds& bounds)
        : list_(list), keys_(bounds.rows, bounds.columns), pages_left_(std::int64_t(bounds.most / page_pairs)) {
        const std::uint64_t spare_pages = bounds.most / page_pairs / 4 / threads;
        const unsigned row_bits = keys_.row_bits();
        const unsigned for_rows = row_bits - std::min(row_bits, objects_a_bucket_bits);
        const unsigned for_pairs = std::min(row_bits, unsigned(std::bit_width(bounds.expected / sorted_at_once * 2)));
        const unsigned wanted = std::min(std::max(for_rows, for_pairs), most_bucket_bits);
        bits_ = std::clamp(wanted, 1u, unsigned(std::bit_width(spare_pages | 2)) - 1);
        workers_.reserve(threads);
        for (unsigned i = 0; i < threads; ++i) {
            workers_.emplace_back(list, pages_left_).found.resize(std::size_t(1) << bits_);
        }
    }

    BucketWriter writer(unsigned worker) { return {keys_, shift(), workers_[worker]}; }

    void append_sorted(Team& team, const std::stop_token& stop) {
        pages_left_ = std::numeric_limits<std::int64_t>::max();  // splitting takes a few more
        std::vector<Runs> sorted(std::size_t(1) << bits_);
        team.for_each(sorted.size(), [&](std::size_t bucket, unsigned worker) {
            std::vector<PageString> strings;
            strings.reserve(workers_.size());
            for (Worker& other : workers_) strings.push_back(std::exchange(other.found[bucket], {}));
            BucketSort(keys_, workers_[worker], stop, sorted[bucket]).sort(std::move(strings), shift());
        });
        for (const Runs& runs : sorted) {
            for (const auto run : runs) list_.append(run);
        }
    }

private:
    unsigned shift() const { return keys_.bits() - bits_; }

    PairList::Storage& list_;
    PairKeys keys_;
    std::atomic<std::int64_t> pages_left_;
    unsigned bits_;
    std::vector<Worker> workers_;
};

AscendingExecutor::AscendingExecutor(Team& team, PairList::Storage& list, const Bounds& bounds)
    : TeamExecutor(team), buckets_(std::make_unique<Buckets>(team.threads(), list, bounds)) {}

AscendingExecutor::~AscendingExecutor() = default;

void AscendingExecutor::for_each_writing(std::size_t count, const std::function<void(std::size_t, PairWriter&)>& body) {
    team().for_each(count, [&](std::size_t i, unsigned worker) {
        BucketWriter writer = buckets_->writer(worker);
        body(i, writer);
    });
}

void AscendingExecutor::append_sorted(const std::stop_token& stop) { buckets_->append_sorted(team(), stop); }

}  // namespace octopair
