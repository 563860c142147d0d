#include "viewer/live/live_feed.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <utility>

#include "viewer/scene/frame_answers.hpp"

namespace octopair::viewer {

namespace {

std::size_t size_of(const LiveState& state) {
    return std::visit([](const auto& boxes) { return boxes.size(); }, state.boxes);
}

Boxes boxes_of(const LiveState& state) {
    return std::visit([](const auto& boxes) { return Boxes(std::span(boxes)); }, state.boxes);
}

/// Compares the bits, because a box that does not exist is NaN.
bool same(const RelativeBox& a, const RelativeBox& b) {
    using Bits = std::array<std::uint32_t, 6>;
    return std::bit_cast<Bits>(a) == std::bit_cast<Bits>(b);
}

}  // namespace

/// Header of a live frame.
struct LiveFeed::Head {
    std::uint32_t magic = 0x4F504C56, frame = 0, base = 0xFFFFFFFF, objects = 0;
    std::uint32_t shown = 0, moved = 0, began = 0, ended = 0;
    std::uint32_t pairs_low = 0, pairs_high = 0, listed = 0, step_microseconds = 0;
    std::uint32_t existing = 0;
    std::uint32_t unused[3] = {};
};

std::size_t LiveFeed::shown() const { return std::min(size_of(*state_), most_shown_); }

void LiveFeed::put(LiveState&& next) {
    const std::lock_guard lock(mutex_);
    // incomplete_ is still true if the last put() ran out of memory. Its differences may be lost, so pages need a whole frame.
    const bool incomplete = std::exchange(incomplete_, true);
    bool whole = incomplete || frame_ < 0 || size_of(next) != size_of(*state_);
    if (!has_origin_) {
        FrameData data;
        data.boxes = boxes_of(next);
        data.exists = next.exists;
        const std::optional<Box3d> bounds = bounds_of(data);
        origin_ = centre_of(bounds.value_or(no_bounds()));
        has_origin_ = bounds.has_value();
        whole = true;
    }
    ++frame_;
    const bool listed_before = pairs_.size() <= max_listed_pairs;
    Difference difference = update_pairs(next);
    began_ = difference.began;
    ended_ = difference.ended;
    // Pages get at most max_listed_pairs pairs. When the number falls below this limit, send a whole frame with all pairs.
    whole |= !listed_before && pairs_.size() <= max_listed_pairs;
    state_ = std::make_shared<const LiveState>(std::move(next));
    update_rows(whole);
    made_.clear();
    if (whole) {
        differences_.clear();
        kept_events_ = 0;
        oldest_base_ = frame_;
        incomplete_ = false;
        return;
    }
    kept_events_ += difference.began.size() + difference.ended.size();
    differences_.push_back(std::move(difference));
    while (differences_.size() > max_differences || kept_events_ > max_events) {
        kept_events_ -= differences_.front().began.size() + differences_.front().ended.size();
        oldest_base_ = differences_.front().frame;
        differences_.pop_front();
    }
    incomplete_ = false;
}

void LiveFeed::update_rows(bool whole) {
    const std::size_t count = shown();
    if (whole) {
        rows_.assign(count, no_box());
        changed_.assign(count, std::uint32_t(frame_));
    }
    const Boxes boxes = boxes_of(*state_);
    for (std::size_t row = 0; row < count; ++row) {
        const bool exists = state_->exists.empty() || state_->exists[row] != 0;
        const RelativeBox box = exists ? relative(box_of(boxes, row), origin_) : no_box();
        if (same(box, rows_[row])) continue;
        rows_[row] = box;
        changed_[row] = std::uint32_t(frame_);
    }
}

/// Sorts the events by pair, and keeps only the last event of each pair.
static void sort_events(std::vector<LiveState::PairEvent>& events) {
    std::stable_sort(events.begin(), events.end(), [](const auto& x, const auto& y) { return x.pair < y.pair; });
    std::size_t kept = 0;
    for (std::size_t i = 0; i < events.size(); ++i) {
        if (i + 1 == events.size() || events[i].pair != events[i + 1].pair) events[kept++] = events[i];
    }
    events.resize(kept);
}

LiveFeed::Difference LiveFeed::update_pairs(LiveState& next) {
    Difference difference{std::uint32_t(frame_), {}, {}};
    if (next.pairs) {
        const std::vector<Pair>& now = *next.pairs;
        std::set_difference(now.begin(), now.end(), pairs_.begin(), pairs_.end(), std::back_inserter(difference.began));
        std::set_difference(pairs_.begin(), pairs_.end(), now.begin(), now.end(), std::back_inserter(difference.ended));
        pairs_ = std::move(*next.pairs);
        next.pairs.reset();
        return difference;
    }
    sort_events(next.events);
    for (const auto& [pair, began] : next.events) {
        const bool known = std::binary_search(pairs_.begin(), pairs_.end(), pair);
        if (began && !known) difference.began.push_back(pair);
        if (!began && known) difference.ended.push_back(pair);
    }
    if (difference.began.empty() && difference.ended.empty()) return difference;
    std::vector<Pair> remaining, merged;
    std::set_difference(pairs_.begin(), pairs_.end(), difference.ended.begin(), difference.ended.end(),
                        std::back_inserter(remaining));
    std::merge(remaining.begin(), remaining.end(), difference.began.begin(), difference.began.end(),
               std::back_inserter(merged));
    pairs_ = std::move(merged);
    return difference;
}

LiveFeed::Head LiveFeed::head() const {
    Head head;
    head.frame = std::uint32_t(frame_);
    head.objects = std::uint32_t(size_of(*state_));
    const auto& exists = state_->exists;
    head.existing = head.objects - std::uint32_t(std::count(exists.begin(), exists.end(), 0));
    head.shown = std::uint32_t(shown());
    const std::uint64_t pairs = std::max<std::uint64_t>(state_->pair_count, pairs_.size());
    head.pairs_low = std::uint32_t(pairs);
    head.pairs_high = std::uint32_t(pairs >> 32);
    head.listed = std::uint32_t(std::min(pairs_.size(), max_listed_pairs));
    head.step_microseconds = std::uint32_t(std::min(state_->step_seconds * 1e6, 4e9));
    return head;
}

std::string LiveFeed::whole_frame() const {
    const Head head = this->head();
    std::string body;
    append_array(body, std::span(&head, 1));
    if (head.shown < head.objects) {
        std::vector<std::uint32_t> objects(head.shown);
        for (std::uint32_t row = 0; row < head.shown; ++row) objects[row] = row;
        append_array(body, std::span<const std::uint32_t>(objects));
    }
    append_array(body, std::span<const RelativeBox>(rows_));
    append_array(body, std::span<const Pair>(pairs_).first(head.listed));
    return body;
}

std::string LiveFeed::difference_since(std::uint32_t last) const {
    std::vector<std::uint32_t> rows;
    for (std::uint32_t row = 0; row < changed_.size(); ++row) {
        if (changed_[row] > last) rows.push_back(row);
    }
    std::vector<LiveState::PairEvent> events;
    for (const Difference& difference : differences_) {
        if (difference.frame <= last) continue;
        for (const Pair pair : difference.ended) events.push_back({pair, false});
        for (const Pair pair : difference.began) events.push_back({pair, true});
    }
    // A pair whose first event is a begin and whose last event is an end, or the reverse, has not changed since `last`.
    std::map<Pair, bool> first;
    for (const auto& [pair, began] : events) first.emplace(pair, began);
    sort_events(events);
    std::erase_if(events, [&](const auto& event) { return first.at(event.pair) != event.began; });

    Head head = this->head();
    head.base = last;
    head.moved = std::uint32_t(rows.size());
    std::vector<Pair> began, ended;
    for (const auto& [pair, is_begin] : events) (is_begin ? began : ended).push_back(pair);
    head.began = std::uint32_t(began.size());
    head.ended = std::uint32_t(ended.size());
    std::vector<RelativeBox> boxes;
    boxes.reserve(rows.size());
    for (const std::uint32_t row : rows) boxes.push_back(rows_[row]);
    std::string body;
    append_array(body, std::span<const Head>(&head, 1));
    append_array(body, std::span<const std::uint32_t>(rows));
    append_array(body, std::span<const RelativeBox>(boxes));
    append_array(body, std::span<const Pair>(began));
    append_array(body, std::span<const Pair>(ended));
    return body;
}

Message LiveFeed::frame_after(std::int64_t last) {
    const std::lock_guard lock(mutex_);
    if (frame_ < 0 || last == frame_) return nullptr;
    const std::int64_t base = last >= oldest_base_ && last < frame_ ? last : -1;
    if (made_.size() > max_messages) made_.clear();
    Message& made = made_[base];
    if (made == nullptr) {
        std::string frame = base < 0 ? std::string() : difference_since(std::uint32_t(base));
        const std::size_t listed = std::min(pairs_.size(), max_listed_pairs);
        const std::size_t whole = sizeof(Head) + rows_.size() * sizeof(RelativeBox) + listed * sizeof(Pair);
        if (base < 0 || frame.size() > whole) frame = whole_frame();  // send whichever is shorter
        made = std::make_shared<const std::string>(std::move(frame));
    }
    return made;
}

LiveFeed::Frame LiveFeed::latest() const {
    const std::lock_guard lock(mutex_);
    Frame frame{{}, began_, ended_};
    FrameData& data = frame.data;
    data.boxes = boxes_of(*state_);
    data.keep = state_;
    data.exists = state_->exists;
    data.pairs = pairs_;
    data.pair_count = std::max<std::uint64_t>(state_->pair_count, pairs_.size());
    return frame;
}

Point3d LiveFeed::origin() const {
    const std::lock_guard lock(mutex_);
    return origin_;
}

}  // namespace octopair::viewer
