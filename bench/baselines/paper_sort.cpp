#include "baselines/paper_sort.hpp"

#include <algorithm>

#include "octree/sweep/sort_key.hpp"

namespace octopair::baselines {

namespace {

constexpr unsigned bits_of_level = 4;
constexpr unsigned max_level = (32 - bits_of_level) / 3;

/// Sorts by path, then by level. These are the high 32 bits of a key, and the position of the entry is the low 32 bits.
/// The radix sort is stable, so entries with equal codes stay in the order of objects.
void radix_sort_entries(PaperList& entries, unsigned level) {
    Buffer<SortKey> keys(entries.size());
    for (std::size_t i = 0; i < entries.size(); ++i) {
        const OctalCode code = entries[i].code;
        const std::uint64_t path = code.key() >> (3 * (OctalCode::max_level - level));
        keys[i] = (path << bits_of_level | code.level()) << 32 | i;
    }
    NoPairs none;
    SerialExecutor alone(none);
    radix_sort(keys, alone, {});
    PaperList sorted(entries.size());
    for (std::size_t i = 0; i < sorted.size(); ++i) sorted[i] = entries[position_of(keys[i])];
    entries = std::move(sorted);
}

}  // namespace

void sort_entries(PaperList& entries, PaperSort sort, unsigned level) {
    if (sort == PaperSort::radix && level <= max_level && entries.size() <= std::uint32_t(-1)) {
        radix_sort_entries(entries, level);
    } else {
        std::sort(entries.begin(), entries.end());
    }
}

}  // namespace octopair::baselines
