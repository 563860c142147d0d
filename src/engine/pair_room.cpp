#include "engine/pair_room.hpp"

#include <algorithm>
#include <chrono>
#include <string>

#include "base/free_memory.hpp"
#include "base/test_hooks.hpp"
#include "base/tuning.hpp"
#include "engine/pair_pages.hpp"
#include "octopair/error.hpp"

namespace octopair {

namespace {

constexpr std::uint64_t unbounded = ~std::uint64_t(0);

std::string text_of(const PairCount& count) {
    return (count.exact ? "" : "more than ") + digit_groups(count.pairs) + " pairs";
}

}  // namespace

// NOLINTNEXTLINE(readability-function-size): the parameters of a call, and what its engine can do.
PairRoom::PairRoom(const Bounds& bounds, detail::PairStorage* list, const Progress& progress, bool forecasts)
    : bounds_(bounds),
      list_(list),
      progress_(progress),
      forecasts_(forecasts),
      most_bytes_(unbounded),
      next_check_(tuning().output.unchecked_bytes),
      next_forecast_(tuning().output.unchecked_bytes / sizeof(Pair)) {
    if (list_ != nullptr) list_->watch([this](std::uint64_t bytes) { grow(bytes); });
}

PairRoom::~PairRoom() {
    if (list_ != nullptr) list_->watch({});
}

/// Returns how many more bytes of memory the pairs can get.
std::optional<std::uint64_t> PairRoom::free() const { return mapped_ ? free_mapped_memory() : free_memory(); }

/// Returns the bytes that the pairs have.
std::uint64_t PairRoom::held() const { return std::max(held_by_engine_, list_->held_bytes()); }

/// Returns how many bytes the pairs can have if they can get `more` bytes.
std::uint64_t PairRoom::room_bytes(std::uint64_t more) const { return std::min(held() + more, most_bytes_); }

std::optional<std::uint64_t> PairRoom::most_in_memory() const {
    const std::optional<std::uint64_t> more = free();
    return more ? std::optional(room_bytes(*more) / sizeof(Pair)) : std::nullopt;
}

/// Forecasts from the pairs of the scanned part of the octree whether all pairs are more than `most`. A crowded octant can make the
/// forecast wrong, because its pairs are found before it counts as scanned.
bool PairRoom::will_exceed(std::uint64_t pairs, std::uint64_t most) const {
    if (bounds_.limit && *bounds_.limit <= most) return false;
    return pairs >= std::min(tuning().output.forecast_pairs, most / 8) &&
           double(pairs) > progress_.of_stage() * double(most);
}

bool PairRoom::is_doubtful(std::uint64_t pairs) {
    if (!forecasts_) return false;
    if (bounds_.max_pairs && will_exceed(pairs, *bounds_.max_pairs)) return true;
    if (list_ == nullptr || pairs < next_forecast_) return false;
    next_forecast_ = pairs + tuning().output.checked_step / sizeof(Pair);
    const std::optional<std::uint64_t> room = most_in_memory();
    return room && will_exceed(pairs, *room);
}

/// Runs before the list allocates a block of `bytes`.
void PairRoom::grow(std::uint64_t bytes) { check_memory(held() / sizeof(Pair), bytes); }

void PairRoom::hold(std::uint64_t bytes, std::uint64_t most) {
    mapped_ = true;
    held_by_engine_ = bytes;
    most_bytes_ = most;
}

void PairRoom::check(std::uint64_t pairs) { check_memory(pairs, tuning().output.checked_step); }

/// Compares a list of `pairs` pairs, which needs `bytes` more, with the free memory.
void PairRoom::check_memory(std::uint64_t pairs, std::uint64_t bytes) {
    const std::uint64_t needed = held() + bytes;
    if (needed < next_check_) return;
    next_check_ = needed + tuning().output.checked_step;
    const std::optional<std::uint64_t> more = free();
    if (!more) return;
    const std::uint64_t room = room_bytes(*more);
    const bool fits = bytes <= *more;
    if (can_count() && (!fits || will_exceed(pairs, room / sizeof(Pair)))) throw OverBudget{};
    if (fits) return;
    throw TooManyPairs("the pairs need more memory than is free (" + byte_text(room) + ")" + list_advice, 0, false);
}

CountLimit PairRoom::count_limit() const {
    const std::uint64_t in_memory = list_ != nullptr ? most_in_memory().value_or(unbounded) : unbounded;
    const std::uint64_t room = std::min(in_memory, bounds_.max_pairs.value_or(unbounded));
    const std::chrono::duration<double> longest(tuning().output.counting_seconds);
    return {room, CountLimit::Clock::now() + std::chrono::duration_cast<CountLimit::Clock::duration>(longest)};
}

void PairRoom::require(PairCount all) {
    forecasts_ = false;
    const std::uint64_t limit = bounds_.limit.value_or(unbounded);
    const PairCount count{std::min(all.pairs, limit), all.exact || all.pairs >= limit};
    if (bounds_.max_pairs && count.exceeds(*bounds_.max_pairs)) {
        throw TooManyPairs(text_of(count) + "; at most " + digit_groups(*bounds_.max_pairs) + " are allowed",
                           count.pairs, count.exact);
    }
    if (list_ == nullptr || count.pairs < tuning().output.unchecked_bytes / sizeof(Pair)) return;
    const std::optional<std::uint64_t> most = most_in_memory();
    if (!most || !count.exceeds(*most)) return;
    throw TooManyPairs(text_of(count) + " need " + (count.exact ? "" : "more than ") +
                           byte_text(count.pairs * sizeof(Pair)) + " of memory, " + byte_text(*most * sizeof(Pair)) +
                           " are free" + list_advice,
                       count.pairs, count.exact);
}

}  // namespace octopair
