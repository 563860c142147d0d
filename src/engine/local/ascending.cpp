// Two passes over the pairs: into buckets of neighbouring `a` (an MSD radix step, shared out by runs of the input),
// then each bucket within the cache, by comparison or, where it is large, by an LSD radix sort over the digits in use.

#include "engine/local/ascending.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <utility>
#include <vector>

#include "base/stop.hpp"

namespace octopair {

namespace {

constexpr unsigned bucket_bits = 11;
constexpr std::size_t radix_from = 2048;  // pairs in a bucket
constexpr unsigned digit_bits = 11;

std::uint64_t key_of(const Pair& pair) { return std::uint64_t(pair.a) << 32 | pair.b; }

/// `a` and `b` as one number of as few bits as the bucket needs.
struct Packing {
    std::uint32_t first_a;
    unsigned b_bits;
    unsigned bits;

    std::uint64_t pack(const Pair& pair) const { return std::uint64_t(pair.a - first_a) << b_bits | pair.b; }
    Pair unpack(std::uint64_t key) const {
        return {std::uint32_t(key >> b_bits) + first_a, std::uint32_t(key & ((std::uint64_t(1) << b_bits) - 1))};
    }
};

Packing packing_of(std::span<const Pair> pairs) {
    std::uint32_t first = pairs[0].a, last = pairs[0].a, most_b = 0;
    for (const Pair& pair : pairs) {
        first = std::min(first, pair.a);
        last = std::max(last, pair.a);
        most_b = std::max(most_b, pair.b);
    }
    const unsigned b_bits = std::max(1u, unsigned(std::bit_width(most_b)));
    return {first, b_bits, b_bits + unsigned(std::bit_width(last - first))};
}

/// Keeps its memory from bucket to bucket.
class BucketSort {
public:
    void sort(std::span<Pair> pairs) {
        if (pairs.size() < radix_from) {
            std::sort(pairs.begin(), pairs.end(), [](const Pair& a, const Pair& b) { return key_of(a) < key_of(b); });
            return;
        }
        const Packing packing = packing_of(pairs);
        keys_.resize_discard(pairs.size());
        other_.resize_discard(pairs.size());
        for (std::size_t i = 0; i < pairs.size(); ++i) keys_[i] = packing.pack(pairs[i]);
        for (unsigned shift = 0; shift < packing.bits; shift += digit_bits) {
            pass(shift);
            std::swap(keys_, other_);
        }
        for (std::size_t i = 0; i < pairs.size(); ++i) pairs[i] = packing.unpack(keys_[i]);
    }

private:
    void pass(unsigned shift) {
        constexpr std::uint64_t digit_mask = (1u << digit_bits) - 1;
        std::array<std::size_t, (1u << digit_bits) + 1> at{};
        for (const std::uint64_t key : keys_.span()) ++at[(key >> shift & digit_mask) + 1];
        for (std::size_t i = 1; i < at.size(); ++i) at[i] += at[i - 1];
        for (const std::uint64_t key : keys_.span()) other_[at[key >> shift & digit_mask]++] = key;
    }

    Buffer<std::uint64_t> keys_, other_;
};

/// A share of the input: some chunks, or parts of them.
struct Share {
    std::vector<std::span<const Pair>> runs;
    std::vector<std::uint64_t> at;  // per bucket: first the number of pairs, then the next one's place
};

std::vector<Share> shares_of(const PairList::Storage& list, unsigned threads) {
    const std::uint64_t even = list.size / threads + 1;
    std::vector<Share> shares(threads);
    std::uint64_t held = 0;
    std::size_t share = 0;
    for (std::span<const Pair> chunk : list.chunks) {
        while (!chunk.empty()) {
            const std::size_t part = std::size_t(std::min<std::uint64_t>(chunk.size(), even - held));
            shares[share].runs.push_back(chunk.first(part));
            chunk = chunk.subspan(part);
            held += part;
            if (held == even) {
                ++share;
                held = 0;
            }
        }
    }
    return shares;
}

}  // namespace

void AscendingOrder::append(const PairList::Storage& unsorted, ObjectRange range, PairList::Storage& sorted) const {
    if (unsorted.size == 0) return;
    const std::uint64_t objects = range.end - range.begin;
    const unsigned shift = unsigned(std::max(0, int(std::bit_width(objects)) - int(bucket_bits)));
    const std::size_t buckets = std::size_t(objects >> shift) + 1;
    const auto bucket_of = [&](const Pair& pair) { return std::size_t((pair.a - range.begin) >> shift); };

    std::vector<Share> shares = shares_of(unsorted, team.threads());
    team.for_each(shares.size(), [&](std::size_t i, unsigned) {
        shares[i].at.assign(buckets, 0);
        for (const auto run : shares[i].runs) {
            throw_if_stopped(stop);
            for (const Pair& pair : run) ++shares[i].at[bucket_of(pair)];
        }
    });
    std::vector<std::uint64_t> ends(buckets);
    std::uint64_t at = 0;
    for (std::size_t bucket = 0; bucket < buckets; ++bucket) {
        for (Share& share : shares) at += std::exchange(share.at[bucket], at);
        ends[bucket] = at;
    }

    const std::span<Pair> out = sorted.take_block(std::size_t(unsorted.size)).first(std::size_t(unsorted.size));
    team.for_each(shares.size(), [&](std::size_t i, unsigned) {
        for (const auto run : shares[i].runs) {
            throw_if_stopped(stop);
            for (const Pair& pair : run) out[std::size_t(shares[i].at[bucket_of(pair)]++)] = pair;
        }
    });
    std::vector<BucketSort> sorters(team.threads());
    team.for_each(buckets, [&](std::size_t bucket, unsigned worker) {
        throw_if_stopped(stop);
        const std::size_t begin = bucket == 0 ? 0 : std::size_t(ends[bucket - 1]);
        const std::span<Pair> pairs = out.subspan(begin, std::size_t(ends[bucket]) - begin);
        if (pairs.size() > 1) sorters[worker].sort(pairs);
    });
    sorted.append(out);
}

}  // namespace octopair
