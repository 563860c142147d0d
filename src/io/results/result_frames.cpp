// ResultFrames: sorts rows by frame, or events by pair, and returns the collisions of a frame.
#include "io/results/result_file.hpp"

#include <algorithm>
#include <tuple>
#include <utility>

namespace octopair::io {

void ResultFrames::add(ResultRow row) {
    std::uint32_t finding = no_finding;
    if (row.finding.collision_class != CollisionClass::unknown) {
        finding = std::uint32_t(findings_.size());
        findings_.push_back(std::move(row.finding));
    }
    rows_.push_back({row.pair, row.frame, finding, row.event});
    frames_ = std::max(frames_, row.frame + 1);
    if (row.event) ++events_;
}

bool ResultFrames::finish() {
    if (events_ != 0 && events_ != rows_.size()) return false;
    if (events_ != 0) {
        pair_up_events();
        return true;
    }
    const auto key = [](const Entry& row) { return std::tuple(row.frame, row.pair, row.finding); };
    const auto before = [&](const Entry& x, const Entry& y) { return key(x) < key(y); };
    if (!std::is_sorted(rows_.begin(), rows_.end(), before)) std::sort(rows_.begin(), rows_.end(), before);
    return true;
}

void ResultFrames::pair_up_events() {
    // The order puts an end before a begin of the same frame. So a pair that ends and begins in one frame collides in this frame.
    const auto key = [](const Entry& row) { return std::tuple(row.pair, row.frame, row.event, row.finding); };
    std::sort(rows_.begin(), rows_.end(), [&](const Entry& x, const Entry& y) { return key(x) < key(y); });
    bool open = false;
    for (std::size_t i = 0; i < rows_.size(); ++i) {
        const Entry& row = rows_[i];
        if (row.event == Event::begin && !open) {
            lifetimes_.push_back({row.pair, row.frame, no_end, row.finding});
            open = true;
        } else if (row.event == Event::end && open) {
            lifetimes_.back().end = row.frame;
            open = false;
        }
        if (i + 1 == rows_.size() || rows_[i + 1].pair != row.pair) open = false;
    }
    rows_ = {};
}

void ResultFrames::append(ResultFrame& frame, Pair pair, std::uint32_t finding) const {
    // A pair that a frame contains twice counts as one pair.
    if (!frame.pairs.empty() && frame.pairs.back() == pair) return;
    frame.pairs.push_back(pair);
    if (!findings_.empty()) frame.findings.push_back(finding == no_finding ? Finding{} : findings_[finding]);
}

ResultFrame ResultFrames::frame(std::uint64_t number) const {
    ResultFrame frame;
    const auto [first, last] = std::equal_range(rows_.begin(), rows_.end(), Entry{{}, std::uint32_t(number), 0, {}},
                                                [](const Entry& x, const Entry& y) { return x.frame < y.frame; });
    frame.pairs.reserve(std::size_t(last - first));
    for (auto row = first; row != last; ++row) append(frame, row->pair, row->finding);
    for (const Lifetime& life : lifetimes_) {
        if (life.begin <= number && number < life.end) append(frame, life.pair, life.finding);
    }
    return frame;
}

bool ResultFrames::has_contacts() const {
    return std::any_of(findings_.begin(), findings_.end(),
                       [](const Finding& finding) { return !finding.contacts.empty(); });
}

}  // namespace octopair::io
