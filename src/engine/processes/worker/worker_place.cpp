#include "engine/processes/worker/worker_place.hpp"

#include <algorithm>
#include <atomic>

#include "base/stop.hpp"
#include "engine/processes/worker_timeouts.hpp"

namespace octopair {

std::span<Pair> WorkerPlace::take_block(std::size_t size) const {
    const std::uint64_t blocks = (size + list_block_pairs - 1) / list_block_pairs;
    const std::uint64_t first = view.control_block().next_block.fetch_add(blocks);
    const std::uint64_t taken = blocks * list_block_pairs;
    return {pairs.array<Pair>(first * list_block_pairs * sizeof(Pair), taken), std::size_t(taken)};
}

void WorkerPlace::record(const Share& share, std::uint64_t number) const {
    shares.reach(CommitPoint::before);
    share.record.pairs = number;
    shares.reach(CommitPoint::within);
}

void WorkerPlace::record(const Share& share, const PairRuns& runs) const {
    shares.reach(CommitPoint::before);
    const std::size_t count = runs.view().size();
    if (count == 0) return;
    const std::uint64_t first = view.control_block().next_run.fetch_add(count);
    const auto rows = view.runs(first, count);
    const auto* const begin = reinterpret_cast<const Pair*>(pairs.data());
    for (std::size_t i = 0; i < count; ++i) {
        const std::span<const Pair> run = runs.view()[i];
        rows[i] = {std::uint64_t(run.data() - begin), run.size()};
        share.record.pairs += run.size();
    }
    shares.reach(CommitPoint::within);
    share.record.first_run = first;
    share.record.runs = std::uint32_t(count);
}

void RingOutput::begin(const WorkerPlace::Share& share) {
    share_ = share.number;
    block_ = {};
}

void RingOutput::commit(const WorkerPlace::Share&) {
    if (block_.empty()) block_ = free_block();
    hand_over(true);
}

void RingOutput::write(std::span<const Pair> pairs) {
    const auto room = [&] {
        if (block_.empty()) block_ = free_block();
        return block_.size() - held_;
    };
    put_in_parts(pairs, room, [&](std::span<const Pair> part) {
        std::copy(part.begin(), part.end(), block_.begin() + std::ptrdiff_t(held_));
        held_ += part.size();
        if (held_ == block_.size()) hand_over(false);
    });
}

std::span<Pair> RingOutput::free_block() {
    const std::uint64_t filled = slot_.ring_filled.load();
    for (;;) {
        const std::uint32_t seen = slot_.command.count.load();
        if (filled - slot_.ring_taken.load() < pass_.ring_blocks) break;
        throw_if_stopped(place_.stop);
        const WaitingMark waiting(slot_);
        slot_.command.wait(seen, worker_timeouts::max_event_sleep, 0);
    }
    held_ = 0;
    const std::uint64_t block = place_.shares.slot() * pass_.ring_blocks + filled % pass_.ring_blocks;
    const std::uint64_t pairs = pass_.block_pairs;
    return {place_.pairs.array<Pair>(block * pairs * sizeof(Pair), pairs), pairs};
}

void RingOutput::hand_over(bool last) {
    const std::uint64_t filled = slot_.ring_filled.load();
    if (last) place_.shares.reach(CommitPoint::before);
    place_.view.ring_entry(place_.shares.slot(), filled) = {share_, held_, last ? 1u : 0u};
    if (last) place_.shares.reach(CommitPoint::within);
    slot_.ring_filled.store(filled + 1);
    place_.view.control_block().for_client.raise();
    block_ = {};
}

}  // namespace octopair
