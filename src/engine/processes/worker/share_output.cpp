#include "engine/processes/worker/share_output.hpp"

#include <algorithm>
#include <atomic>
#include <vector>

#include "base/stop.hpp"
#include "engine/processes/worker_timeouts.hpp"
#include "engine/threads/writers.hpp"

namespace octopair {

namespace {

class CountOutput final : public ShareOutput, private ShareWriter {
public:
    ShareWriter& begin(const WorkSharing::ClaimedShare&) override {
        pairs_ = 0;
        return *this;
    }
    void end(const WorkSharing::ClaimedShare& share) override { share.record.pairs = pairs_; }

private:
    bool counting() const override { return true; }
    void write(std::span<const Pair> pairs) override { pairs_ += pairs.size(); }
    void write_count(std::uint64_t pairs) override { pairs_ += pairs; }

    std::uint64_t pairs_ = 0;
};

class CountByObjectOutput final : public ShareOutput {
public:
    explicit CountByObjectOutput(std::span<std::uint32_t> counts) : writer_(counts) {}
    ShareWriter& begin(const WorkSharing::ClaimedShare&) override { return writer_; }
    void end(const WorkSharing::ClaimedShare&) override {}

private:
    CountByObjectWriter writer_;
};

using Runs = std::vector<std::span<const Pair>>;

class ListOutput final : public ShareOutput, private FullWriter {
public:
    explicit ListOutput(const OutputPlace& place) : place_(place) {}

    ShareWriter& begin(const WorkSharing::ClaimedShare&) override {
        runs_.clear();
        return *this;
    }
    void end(const WorkSharing::ClaimedShare& share) override { record_runs(place_, runs_, share.record); }

private:
    void write(std::span<const Pair> pairs) override {
        while (!pairs.empty()) {
            if (block_.empty()) block_ = take_block(place_);
            const auto part = pairs.first(std::min(pairs.size(), block_.size()));
            std::copy(part.begin(), part.end(), block_.begin());
            runs_.push_back(block_.first(part.size()));
            block_ = block_.subspan(part.size());
            pairs = pairs.subspan(part.size());
        }
    }

    OutputPlace place_;
    std::span<Pair> block_;  // free part of the current block
    Runs runs_;
};

class StreamOutput final : public ShareOutput, private FullWriter {
public:
    StreamOutput(const OutputPlace& place, const Pass& pass)
        : place_(place), pass_(pass), slot_(place.view.slot(place.shares.slot())) {}

    ShareWriter& begin(const WorkSharing::ClaimedShare& share) override {
        share_ = share.number;
        block_ = {};
        return *this;
    }
    void end(const WorkSharing::ClaimedShare&) override {
        if (block_.empty()) block_ = free_block();
        hand_over(true);
    }

private:
    void write(std::span<const Pair> pairs) override {
        while (!pairs.empty()) {
            if (block_.empty()) block_ = free_block();
            const auto part = pairs.first(std::min(pairs.size(), block_.size() - held_));
            std::copy(part.begin(), part.end(), block_.begin() + std::ptrdiff_t(held_));
            held_ += part.size();
            pairs = pairs.subspan(part.size());
            if (held_ == block_.size()) hand_over(false);
        }
    }

    std::span<Pair> free_block() {
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

    void hand_over(bool last) {
        const std::uint64_t filled = slot_.ring_filled.load();
        place_.view.ring_entry(place_.shares.slot(), filled) = {share_, held_, last ? 1u : 0u};
        slot_.ring_filled.store(filled + 1);
        place_.view.control_block().for_client.raise();
        block_ = {};
    }

    OutputPlace place_;
    const Pass& pass_;
    Slot& slot_;
    std::uint64_t share_ = 0;
    std::span<Pair> block_;
    std::size_t held_ = 0;  // pairs in block_
};

}  // namespace

std::unique_ptr<ShareOutput> make_count_output() { return std::make_unique<CountOutput>(); }

std::unique_ptr<ShareOutput> make_count_by_object_output(std::span<std::uint32_t> counts) {
    return std::make_unique<CountByObjectOutput>(counts);
}

std::unique_ptr<ShareOutput> make_list_output(const OutputPlace& place) { return std::make_unique<ListOutput>(place); }

std::unique_ptr<ShareOutput> make_stream_output(const OutputPlace& place, const Pass& pass) {
    return std::make_unique<StreamOutput>(place, pass);
}

std::span<Pair> take_block(const OutputPlace& place) {
    const std::uint64_t block = place.view.control_block().next_block.fetch_add(1);
    return {place.pairs.array<Pair>(block * list_block_pairs * sizeof(Pair), list_block_pairs), list_block_pairs};
}

void record_runs(const OutputPlace& place, std::span<const std::span<const Pair>> runs, Share& record) {
    Runs joined;
    for (const auto run : runs) {
        record.pairs += run.size();
        if (!joined.empty() && joined.back().data() + joined.back().size() == run.data()) {
            joined.back() = {joined.back().data(), joined.back().size() + run.size()};
        } else {
            joined.push_back(run);
        }
    }
    if (joined.empty()) return;
    const std::uint64_t first = place.view.control_block().next_run.fetch_add(joined.size());
    const auto rows = place.view.runs(first, joined.size());
    const auto* const begin = reinterpret_cast<const Pair*>(place.pairs.data());
    for (std::size_t i = 0; i < joined.size(); ++i) {
        rows[i] = {std::uint64_t(joined[i].data() - begin), joined[i].size()};
    }
    record.first_run = first;
    record.runs = std::uint32_t(joined.size());
}

}  // namespace octopair
