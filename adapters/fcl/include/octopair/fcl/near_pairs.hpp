// NearPairs: calls a function for pairs of near boxes, as FCL's distance() does: for each pair whose boxes are less than a limit
// apart, while the function lowers the limit.
//
// Order     Pairs of a batch of seekers, by ascending distance of their boxes. So the limit falls early, and few pairs are called.
// Method    Many seekers: some of them query the scene for their nearest targets, which lowers the limit. A search with the limit
//           as margin then lists all pairs that can be nearer.
//           Few seekers, or very many pairs within the limit: each seeker queries the scene for its nearest targets within the
//           limit, then for more of them, in rounds. A seeker is done when the scene returns fewer targets than the query
//           allows. Seekers that need very many targets test all.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <span>
#include <tuple>
#include <vector>

#include "octopair/engine.hpp"
#include "octopair/fcl/object_set.hpp"

namespace octopair::fcl::detail {

/// `Calls` has these members:
///     static constexpr bool is_self                                  whether the seekers are the targets, in order()
///     bool wants(std::uint32_t seeker, std::uint32_t target)         whether the pair is to be called
///     bool call(std::uint32_t seeker, std::uint32_t target, S& limit)  calls it; returns whether to stop
/// A seeker is a position in `seekers`, a target an index of `targets`.
template <typename S, typename Calls>
class NearPairs {
public:
    NearPairs(const ObjectSet<S>& targets, std::span<const Box<S>> seekers, Calls calls)
        : targets_(targets), seekers_(seekers), calls_(calls) {}

    void run(Engine& engine) {
        if (seekers_.size() > 16 && seekers_.size() > targets_.size() / few) search_with_margin(engine);
        if (!is_done_) search_in_rounds();
    }

private:
    /// A pair to call.
    struct Candidate {
        double distance;
        std::uint32_t seeker, target;
        bool operator<(const Candidate& other) const {
            return std::tie(distance, seeker, target) < std::tie(other.distance, other.seeker, other.target);
        }
    };

    static constexpr std::size_t few = 16;               // a search of all pairs costs this part of a query per object
    static constexpr std::size_t samples = 32;           // one seeker in so many lowers the limit for the others
    static constexpr std::size_t max_pairs = 16;         // per object, of a search with margin
    static constexpr std::size_t max_count = 256;        // an answer's cost grows with the number of targets
    static constexpr std::size_t max_answers = 1 << 16;  // bounds the memory for answers

    /// Calls all pairs and sets is_done_, unless too many pairs are within the limit.
    void search_with_margin(Engine& engine) {
        std::vector<std::uint32_t> sample;
        const std::size_t stride = std::clamp<std::size_t>(seekers_.size() / 16, 1, samples);
        for (std::size_t i = 0; i < seekers_.size(); i += stride) sample.push_back(std::uint32_t(i));
        is_sampling_ = true;
        is_done_ = search(sample, 3);
        is_sampling_ = false;
        unfinished_.clear();
        if (is_done_ || !(limit_ < std::numeric_limits<S>::max())) return;

        std::vector<Box<S>> boxes;
        for (const std::uint32_t index : targets_.order()) boxes.push_back(targets_.box(index));
        const Objects all{.boxes = std::span<const Box<S>>(boxes)};
        const Input input = Calls::is_self ? Input(all) : Input(Join{Objects{.boxes = seekers_}, all});
        const std::uint64_t most = max_pairs * (seekers_.size() + boxes.size());
        PairList found;
        (void)engine.find_pairs(input, found, {.order = Order::octal, .margin = double(limit_), .limit = most});
        if (found.size() == most) return;

        std::sort(called_pairs_.begin(), called_pairs_.end());
        candidates_.clear();
        for (const auto chunk : found.chunks()) {
            for (const auto [a, b] : chunk) note_candidate(a, targets_.order()[b]);
        }
        call_candidates();
        is_done_ = true;
    }

    void search_in_rounds() {
        std::sort(called_pairs_.begin(), called_pairs_.end());
        for (std::uint32_t i = 0; i < seekers_.size(); ++i) pending_.push_back(i);
        std::size_t batch = 16;  // small batches first: their pairs lower the limit for all others
        for (std::size_t count = 4; !pending_.empty() && count <= max_count; count *= 4) {
            for (std::size_t begin = 0, size = 0; begin < pending_.size(); begin += size) {
                size = std::min({batch, std::max<std::size_t>(1, max_answers / count), pending_.size() - begin});
                batch *= 2;
                if (search(std::span(pending_).subspan(begin, size), count)) return;
            }
            pending_.swap(unfinished_);
            unfinished_.clear();
            called_ = count;
        }
        for (const std::uint32_t seeker : pending_) {
            if (test_all(seeker)) return;
        }
    }

    /// Calls the pairs of `seekers` with their nearest `count` targets, less the `called_` nearest. Notes seekers that may
    /// have more near targets. Returns true to stop.
    bool search(std::span<const std::uint32_t> seekers, std::size_t count) {
        query(seekers, count);
        candidates_.clear();
        for (std::size_t i = 0; i < seekers.size(); ++i) {
            const auto near = answers_[i];
            for (std::size_t j = called_; j < near.size(); ++j) {
                if (!calls_.wants(seekers[i], near[j].index) || was_called(seekers[i], near[j].index)) continue;
                candidates_.push_back({near[j].distance, seekers[i], near[j].index});
            }
        }
        if (call_candidates()) return true;
        for (std::size_t i = 0; i < seekers.size(); ++i) {
            const auto near = answers_[i];
            const bool is_unfinished = near.size() == count && near.back().distance < double(limit_);
            if (is_unfinished && count < targets_.size()) unfinished_.push_back(seekers[i]);
        }
        return false;
    }

    void query(std::span<const std::uint32_t> seekers, std::size_t count) {
        places_.clear();
        for (const std::uint32_t seeker : seekers) places_.push_back(to_double(seekers_[seeker]));
        const double within = std::max(double(limit_), 0.0);
        targets_.scene_to_query(places_.size()).nearest(places_, NearestLimits{count, within}, answers_);
    }

    /// Calls the pairs of a seeker with all targets but the `called_` nearest. Returns true to stop.
    bool test_all(std::uint32_t seeker) {
        query(std::span(&seeker, 1), called_);
        std::vector<std::uint32_t> called;
        for (const Neighbor& neighbor : answers_.all) called.push_back(neighbor.index);
        std::sort(called.begin(), called.end());
        candidates_.clear();
        for (const std::uint32_t target : targets_.order()) {
            if (!std::binary_search(called.begin(), called.end(), target)) note_candidate(seeker, target);
        }
        return call_candidates();
    }

    /// Appends a pair to the candidates, if it is near enough and still to be called.
    void note_candidate(std::uint32_t seeker, std::uint32_t target) {
        const double apart = distance(to_double(seekers_[seeker]), to_double(targets_.box(target)));
        if (!(apart < double(limit_)) || !calls_.wants(seeker, target) || was_called(seeker, target)) return;
        candidates_.push_back({apart, seeker, target});
    }

    /// Returns whether the sample of search_with_margin() has called the pair. Requires: called_pairs_ is sorted.
    bool was_called(std::uint32_t seeker, std::uint32_t target) const {
        return !is_sampling_ && std::binary_search(called_pairs_.begin(), called_pairs_.end(), Pair{seeker, target});
    }

    static double distance(const Box3d& a, const Box3d& b) {
        double square = 0;
        for (int axis = 0; axis < 3; ++axis) {
            const double gap = std::max({0.0, a.min[axis] - b.max[axis], b.min[axis] - a.max[axis]});
            square += gap * gap;
        }
        return std::sqrt(square);
    }

    bool call_candidates() {
        std::sort(candidates_.begin(), candidates_.end());
        for (const Candidate& candidate : candidates_) {
            if (!(candidate.distance < double(limit_))) break;
            if (is_sampling_) called_pairs_.push_back({candidate.seeker, candidate.target});
            if (calls_.call(candidate.seeker, candidate.target, limit_)) return true;
        }
        return !(limit_ > 0);  // no distance is below the limit
    }

    const ObjectSet<S>& targets_;
    std::span<const Box<S>> seekers_;
    Calls calls_;
    S limit_ = std::numeric_limits<S>::max();
    bool is_done_ = false;
    bool is_sampling_ = false;
    std::vector<Pair> called_pairs_;  ///< seekers and targets that the sample has called
    std::size_t called_ = 0;          ///< number of nearest targets of pending seekers whose pairs have been called
    std::vector<std::uint32_t> pending_, unfinished_;
    std::vector<Box3d> places_;
    Answers<Neighbor> answers_;
    std::vector<Candidate> candidates_;
};

}  // namespace octopair::fcl::detail
