#include "engine/processes/client/ring_reader.hpp"

#include <algorithm>

#include "base/test_hooks.hpp"
#include "base/tuning.hpp"
#include "octopair/error.hpp"

namespace octopair {

namespace {

[[noreturn]] void throw_damaged_ring() {
    throw Error(ErrorCode::engine_failed, "shared memory: the ring of a worker is damaged");
}

}  // namespace

RingSize ring_size(std::uint64_t pairs, unsigned slots) {
    const std::uint64_t a_slot = std::max<std::uint64_t>(2, pairs / slots);
    const std::uint64_t block = std::clamp<std::uint64_t>(a_slot / 16, 1, tuning().processes.ring_block);
    return {std::clamp<std::uint64_t>(a_slot / block, 2, max_ring_blocks), block};
}

bool RingReader::take() {
    const bool more = take_next();
    // Drop blocks of shares that were already delivered: a replacement worker may have run such a share again.
    for (unsigned slot = 0; slot < pass_.workers; ++slot) {
        while (const auto entry = front(slot)) {
            if (entry->share >= share_) break;
            give_back(slot);
        }
    }
    return more;
}

bool RingReader::take_next() {
    // A share that has not begun has another pass's number in its state.
    for (unsigned blocks = 0; share_ < max_shares;) {
        const Share& share = pool_.view().shares(share_, 1)[0];
        const ShareState state = ShareState::of(share.state.load());
        if (state.pass != pool_.number() || state.slot >= pass_.workers) return false;
        if (share.step.load() != unsigned(Step::scan)) {
            if (state.status != ShareStatus::done) return false;
            ++share_;
        } else if (!take_block(state.slot)) {
            return false;
        } else if (++blocks == tuning().processes.blocks_at_once) {
            pool_.view().control_block().for_client.raise();
            return true;
        }
    }
    return false;
}

/// Returns the front entry of a slot's ring, or nothing if the ring is empty.
std::optional<RingEntry> RingReader::front(unsigned number) const {
    const Slot& slot = pool_.view().slot(number);
    const std::uint64_t taken = slot.ring_taken.load();
    const std::uint64_t filled = slot.ring_filled.load();
    if (filled == taken) return std::nullopt;
    const RingEntry entry = pool_.view().ring_entry(number, taken);
    const bool valid = filled - taken <= pass_.ring_blocks && entry.pairs <= pass_.block_pairs;
    if (!valid) throw_damaged_ring();
    return entry;
}

void RingReader::give_back(unsigned number) {
    Slot& slot = pool_.view().slot(number);
    slot.ring_taken.fetch_add(1);
    slot.command.raise();
}

/// Takes the front block of the slot that has the next share, and delivers its new pairs. Returns false if the ring is empty.
bool RingReader::take_block(unsigned number) {
    const auto next = front(number);
    if (!next) return false;
    const RingEntry entry = *next;
    if (entry.share > share_) throw_damaged_ring();
    if (entry.share == share_) {
        const std::uint64_t taken = pool_.view().slot(number).ring_taken.load();
        if (taken >= pass_.ring_blocks) count_path(Path::ring_wrapped);
        const std::uint64_t block = number * pass_.ring_blocks + taken % pass_.ring_blocks;
        const std::span<const Pair> pairs{
            pairs_.array<const Pair>(block * pass_.block_pairs * sizeof(Pair), pass_.block_pairs),
            std::size_t(entry.pairs)};
        const std::uint64_t known = std::min<std::uint64_t>(entry.pairs, delivered_ - std::min(delivered_, passed_));
        passed_ += entry.pairs;
        delivered_ = std::max(delivered_, passed_);
        if (known < entry.pairs) deliver_(pairs.subspan(known));
        if (entry.last != 0) {
            ++share_;
            delivered_ = passed_ = 0;
        }
    }
    give_back(number);
    return true;
}

void RingReader::forget_unfinished(unsigned number) {
    Slot& slot = pool_.view().slot(number);
    const std::uint64_t share = slot.share.load();
    if (share == 0) return;
    const ShareState state = ShareState::of(pool_.view().shares(share - 1, 1)[0].state.load());
    if (!state.is(pool_.number(), ShareStatus::claimed)) return;
    std::uint64_t filled = slot.ring_filled.load();
    if (filled - slot.ring_taken.load() > pass_.ring_blocks) throw_damaged_ring();
    while (filled > slot.ring_taken.load() && pool_.view().ring_entry(number, filled - 1).share == share - 1) --filled;
    slot.ring_filled.store(filled);
    if (share - 1 == share_) passed_ = 0;
}

}  // namespace octopair
