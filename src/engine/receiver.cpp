#include "engine/receiver.hpp"

#include <algorithm>

#include "base/timed.hpp"
#include "base/tuning.hpp"
#include "engine/pair_list.hpp"

namespace octopair {

void Receiver::take(std::span<const Pair> pairs) {
    const std::uint64_t room = limit_ ? *limit_ - pairs_ : ~std::uint64_t(0);
    const auto kept = pairs.first(std::size_t(std::min<std::uint64_t>(pairs.size(), room)));
    pairs_ += kept.size();
    if (!kept.empty()) deliver(kept);
    if (kept.size() < pairs.size()) {
        truncated_ = true;
        throw LimitReached{};
    }
}

void Receiver::flush() {
    if (held_.empty()) return;
    give(held_);
    held_.clear();
}

void Receiver::deliver(std::span<const Pair> pairs) {
    if (output_.list != nullptr) return keep(pairs);
    if (held_.size() + pairs.size() > tuning().output.batch) flush();
    if (pairs.size() >= tuning().output.batch) {
        give(pairs);
    } else {
        held_.insert(held_.end(), pairs.begin(), pairs.end());
    }
}

void Receiver::give(std::span<const Pair> pairs) {
    const Timed timed(sink_seconds_);
    (*output_.sink)(pairs);
}

void Receiver::keep(std::span<const Pair> pairs) {
    detail::PairStorage& list = detail::storage_of(*output_.list);
    list.append(list.copy(pairs));
}

}  // namespace octopair
