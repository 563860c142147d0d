#include "service/server/jobs/kept_pairs.hpp"

#include <algorithm>
#include <string>

#include "service/protocol/errors.hpp"
#include "service/protocol/messages.hpp"

namespace octopair::service {

namespace {

constexpr std::size_t piece_pairs = piece_bytes / sizeof(Pair);
constexpr std::size_t small_pairs = 2048;  // initial size of the first piece, which grows

}  // namespace

void check_pair_limit(std::uint64_t pairs, std::uint64_t most) {
    if (most == 0 || pairs <= most) return;
    throw LimitError("pairs", most,
                     "pairs: the job has more than " + std::to_string(most) +
                         " pairs, the limit of the server; count them, or set a limit");
}

void PairsInMemory::append(std::span<const Pair> pairs) {
    size_ += pairs.size();
    check_pair_limit(size_, most_);
    while (!pairs.empty()) {
        if (room().empty()) open_piece();
        const std::span<Pair> free = room();
        const std::size_t count = std::min(free.size(), pairs.size());
        std::copy_n(pairs.begin(), count, free.begin());
        used_ += count;
        pairs = pairs.subspan(count);
    }
}

/// Returns the unfilled part of open_.
std::span<Pair> PairsInMemory::room() const {
    const std::span<std::byte> bytes = room_in(open_);
    return std::span(reinterpret_cast<Pair*>(bytes.data()), bytes.size() / sizeof(Pair)).subspan(used_);
}

/// Starts the next piece, or enlarges the first one. The first piece starts small, so that a job with few pairs takes little
/// memory.
void PairsInMemory::open_piece() {
    const std::size_t had = open_.size() / sizeof(Pair);
    const bool grow = full_.empty() && had < piece_pairs;
    const std::size_t count = grow ? std::clamp(4 * had, small_pairs, piece_pairs) : piece_pairs;
    reservation_.grow((grow ? count - had : count) * sizeof(Pair));
    grpc::Slice larger = make_slice(count * sizeof(Pair));
    if (grow) {
        std::copy_n(room_in(open_).begin(), used_ * sizeof(Pair), room_in(larger).begin());
    } else {
        const std::lock_guard lock(mutex_);
        full_.push_back(open_);
        ready_ += had;
        used_ = 0;
    }
    open_ = std::move(larger);
}

void PairsInMemory::finish() {
    const std::lock_guard lock(mutex_);
    if (used_ > 0) full_.push_back(open_.sub(0, used_ * sizeof(Pair)));
    ready_ += used_;
    used_ = 0;
    open_ = grpc::Slice();
}

std::optional<grpc::Slice> PairsInMemory::piece(std::uint64_t offset) const {
    const std::lock_guard lock(mutex_);
    if (offset >= ready_) return {};
    const grpc::Slice& whole = full_[std::size_t(offset / piece_pairs)];
    const std::size_t begin = std::size_t(offset % piece_pairs) * sizeof(Pair);
    return begin == 0 ? whole : whole.sub(begin, whole.size());
}

std::uint64_t PairsInMemory::ready() const {
    const std::lock_guard lock(mutex_);
    return ready_;
}

}  // namespace octopair::service
