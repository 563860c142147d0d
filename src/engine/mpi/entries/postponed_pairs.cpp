#include "engine/mpi/entries/postponed_pairs.hpp"

#include <algorithm>
#include <bit>
#include <functional>
#include <span>
#include <utility>

#include "base/test_hooks.hpp"
#include "engine/mpi/comm/agreement.hpp"
#include "engine/mpi/entries/known_boxes.hpp"
#include "engine/mpi/entries/object_fetch.hpp"

namespace octopair {

std::vector<PostponedPair> refused_pairs(Communicator& comm, const JointCall& call,
                                         const std::array<Objects, 2>& slices, std::vector<PostponedPair> postponed) {
    Agreement agreement(comm);
    std::array<std::vector<std::uint32_t>, 2> wanted;
    const auto second_begin = call.join ? std::uint32_t(call.totals[0]) : 0;
    agreement.together([&] {
        for (const auto& [pair, place] : postponed) {
            wanted[0].push_back(pair.a);
            wanted[call.join ? 1 : 0].push_back(pair.b - second_begin);
        }
        for (auto& positions : wanted) {
            std::ranges::sort(positions);
            positions.erase(std::unique(positions.begin(), positions.end()), positions.end());
        }
    });
    std::array<ObjectArrays, 2> fetched;
    for (unsigned set = 0; set < (call.join ? 2 : 1); ++set)
        fetched[set] = fetch_objects(comm, {call, set, slices[set]}, wanted[set]);
    agreement.together([&] {
        if (!postponed.empty()) count_path(Path::ranks_pair_postponed);
        const KnownBoxes boxes(call, fetched);
        const bool keeps_all = planted(Fault::postponed_pairs_kept);
        std::erase_if(postponed, [&](const PostponedPair& postponed_pair) {
            return keeps_all || boxes.is_pair(postponed_pair.pair.a, postponed_pair.pair.b);
        });
        if (!postponed.empty()) count_path(Path::ranks_pair_refused);
        for (PostponedPair& refused : postponed) refused.pair.b -= second_begin;
    });
    return postponed;
}

namespace {

/// A set of pairs. For most other pairs, may_have() is false.
class PairFilter {
public:
    explicit PairFilter(std::vector<Pair> pairs)
        : pairs_(std::move(pairs)),
          shift_(64 - unsigned(std::bit_width(64 * pairs_.size()))),
          marks_((std::size_t(1) << (64 - shift_)) / 8, 0) {
        std::ranges::sort(pairs_);
        for (const Pair& pair : pairs_) marks_[hash(pair) / 8] |= std::uint8_t(1u << hash(pair) % 8);
    }
    unsigned may_have(const Pair& pair) const { return unsigned(marks_[hash(pair) / 8]) >> hash(pair) % 8 & 1u; }
    bool has(const Pair& pair) const { return may_have(pair) != 0 && std::ranges::binary_search(pairs_, pair); }

private:
    std::size_t hash(const Pair& pair) const {
        return std::size_t((std::uint64_t(pair.a) << 32 | pair.b) * 0x9E3779B97F4A7C15ull >> shift_);
    }

    std::vector<Pair> pairs_;
    unsigned shift_;
    std::vector<std::uint8_t> marks_;  // a bit for each hash: 1 if a pair has this hash
};

/// Divides the chunks of a list at pairs that are at their places in the list, and so removes these pairs. Returns the other pairs.
std::vector<Pair> cut_out(detail::PairStorage& list, std::vector<PostponedPair> removed) {
    constexpr std::less<> before;
    std::ranges::sort(removed, before, &PostponedPair::place);
    std::vector<std::span<const Pair>> chunks;
    std::vector<std::uint8_t> cut(removed.size(), 0);
    for (const std::span<const Pair> chunk : list.chunks) {
        const Pair* begin = chunk.data();
        const Pair* const end = begin + chunk.size();
        auto next = std::ranges::lower_bound(removed, begin, before, &PostponedPair::place);
        for (; next != removed.end() && before(next->place, end); ++next) {
            if (*next->place != next->pair) continue;  // the memory had the pair before it belonged to the list
            if (begin != next->place) chunks.push_back({begin, next->place});
            begin = next->place + 1;
            cut[std::size_t(next - removed.begin())] = 1;
        }
        if (begin != end) chunks.push_back({begin, end});
    }
    list.chunks = std::move(chunks);
    list.size -= std::uint64_t(std::ranges::count(cut, 1));
    std::vector<Pair> others;
    for (std::size_t i = 0; i < removed.size(); ++i) {
        if (cut[i] == 0) others.push_back(removed[i].pair);
    }
    return others;
}

}  // namespace

void remove_pairs(detail::PairStorage& list, std::vector<PostponedPair> removed) {
    std::vector<Pair> others = cut_out(list, std::move(removed));
    if (others.empty()) return;
    const PairFilter filter(std::move(others));
    list.keep_some([&](std::span<Pair> pairs) {
        constexpr std::size_t most = 64;  // pairs that are tested at a time, without a branch for each
        Pair* out = pairs.data();
        for (std::size_t begin = 0; begin < pairs.size(); begin += most) {
            const auto some = pairs.subspan(begin, std::min(most, pairs.size() - begin));
            unsigned marks = 0;
            for (const Pair& pair : some) marks |= filter.may_have(pair);
            if (marks == 0) {
                out = out == some.data() ? out + some.size() : std::copy(some.begin(), some.end(), out);
            } else {
                for (const Pair& pair : some) {
                    *out = pair;
                    out += filter.has(pair) ? 0 : 1;
                }
            }
        }
        return std::size_t(out - pairs.data());
    });
}

}  // namespace octopair
