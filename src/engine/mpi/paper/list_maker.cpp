#include "engine/mpi/paper/list_maker.hpp"

#include <array>
#include <utility>

namespace octopair {

// NOLINTNEXTLINE(readability-function-size): objects, octants, number of the first object, stop.
SortedList ListMaker::make(const EntrySource& source, const OctreeLayout& layout, std::uint32_t first_object,
                           const std::stop_token& stop) {
    memory_.resize(source.size(), 1, layout.directory.octants().size(), 1);
    const NumberedBlock block{0, {0, source.size()}};
    const std::array whole = {NumberedOctants{0, 0, OctantIndex(memory_.octants)}};
    const std::array<std::size_t, 1> alone = {0};
    const std::array<std::uint64_t, 1> begin = {0};
    const BuildSteps steps{source, layout.space, layout.directory, memory_, stop};
    steps.encode(block);
    steps.count(whole[0], alone);
    const auto count = std::size_t(memory_.totals[0]);
    entries_.resize_discard(count + 1);
    steps.scatter(block, {entries_.span(), begin, whole, count});
    if (memory_.valid[0] == 0) throw LinearOctree::Invalid{0};
    const std::span<Entry> entries = entries_.span().first(count);
    for (Entry& entry : entries) entry.object += first_object;
    const BuildMemory& made = memory_;
    return {entries, made.places.span().first(made.octants), made.places.span().subspan(made.octants, made.octants)};
}

}  // namespace octopair
