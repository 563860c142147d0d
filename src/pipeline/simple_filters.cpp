// Filters that use no geometry: a condition of the caller, groups and masks, ignored pairs, parents. The filters of the
// command `detect` are chosen in cli/detect/filter_chain.cpp.
// Start here to add a new filter.
#include <algorithm>
#include <bit>
#include <utility>

#include "octopair/error.hpp"
#include "octopair/filters.hpp"
#include "pipeline/per_object.hpp"

namespace octopair {

namespace {

class ConditionFilter final : public Filter {
public:
    ConditionFilter(std::string name, std::function<bool(Pair)> keep)
        : name_(std::move(name)), keep_(std::move(keep)) {}

    std::string_view name() const override { return name_; }
    void apply(Batch& batch) const override {
        batch.keep_if([&](std::size_t i) { return keep_(batch.pairs()[i]); });
    }

private:
    std::string name_;
    std::function<bool(Pair)> keep_;
};

class GroupFilter final : public Filter {
public:
    GroupFilter(const GroupMasks& first, const std::optional<GroupMasks>& second)
        : groups_("group", first.groups, second ? std::optional(second->groups) : std::nullopt),
          masks_("group", first.masks, second ? std::optional(second->masks) : std::nullopt) {}

    std::string_view name() const override { return "groups"; }
    void apply(Batch& batch) const override {
        batch.keep_if([&](std::size_t i) {
            const auto [a, b] = batch.pairs()[i];
            return (groups_.first(a) & masks_.second(b)) != 0 && (groups_.second(b) & masks_.first(a)) != 0;
        });
    }

private:
    PerObject<std::uint32_t> groups_, masks_;
};

void check_sizes(const GroupMasks& set) {
    if (set.groups.size() != set.masks.size()) {
        throw Error(ErrorCode::bad_input, std::to_string(set.groups.size()) + " groups and " +
                                              std::to_string(set.masks.size()) +
                                              " masks; each object needs one group and one mask");
    }
}

/// A set of pairs: a hash table with linear probing, at most half full.
class PairSet {
public:
    explicit PairSet(const std::vector<Pair>& pairs)
        : places_(std::bit_ceil(std::max<std::size_t>(4, pairs.size() * 2)), free_place) {
        for (const Pair pair : pairs) places_[find(pair)] = key(pair);
    }

    bool contains(Pair pair) const { return places_[find(pair)] != free_place; }

private:
    /// Key of a free place. No pair has it, because indices of objects are less than 2^32 - 1.
    static constexpr std::uint64_t free_place = ~std::uint64_t(0);

    static std::uint64_t key(Pair pair) { return std::uint64_t(pair.a) << 32 | pair.b; }
    /// Returns the place of a pair, or the free place where it would be inserted.
    std::size_t find(Pair pair) const {
        const std::uint64_t wanted = key(pair), mixed = (wanted ^ wanted >> 29) * 0x9E3779B97F4A7C15u;
        std::size_t place = std::size_t(mixed ^ mixed >> 32) & (places_.size() - 1);
        while (places_[place] != wanted && places_[place] != free_place) place = (place + 1) & (places_.size() - 1);
        return place;
    }

    std::vector<std::uint64_t> places_;
};

class IgnoredPairsFilter final : public Filter {
public:
    explicit IgnoredPairsFilter(const std::vector<Pair>& ignored) : ignored_(ignored) {}

    std::string_view name() const override { return "ignored pairs"; }
    void apply(Batch& batch) const override {
        batch.keep_if([&](std::size_t i) { return !ignored_.contains(batch.pairs()[i]); });
    }

private:
    PairSet ignored_;
};

class ParentFilter final : public Filter {
public:
    explicit ParentFilter(const PerObject<std::uint32_t>& parents) : parents_(parents) {}

    std::string_view name() const override { return "same parent"; }
    void apply(Batch& batch) const override {
        batch.keep_if([&](std::size_t i) {
            const auto [a, b] = batch.pairs()[i];
            return parents_.first(a) != parents_.second(b);
        });
    }

private:
    PerObject<std::uint32_t> parents_;
};

}  // namespace

std::unique_ptr<Filter> make_filter(std::string name, std::function<bool(Pair)> keep) {
    if (!keep) throw Error(ErrorCode::usage, "filter " + name + " has no condition");
    return std::make_unique<ConditionFilter>(std::move(name), std::move(keep));
}

std::unique_ptr<Filter> make_group_filter(const GroupMasks& first, const std::optional<GroupMasks>& second) {
    check_sizes(first);
    if (second) check_sizes(*second);
    return std::make_unique<GroupFilter>(first, second);
}

std::unique_ptr<Filter> make_ignored_pairs_filter(std::vector<Pair> ignored, bool join) {
    constexpr std::uint32_t no_object = 0xFFFFFFFF;
    for (Pair& pair : ignored) {
        if (pair.a == no_object || pair.b == no_object) {
            throw Error(ErrorCode::bad_input, "ignored pairs: no object has the number " + std::to_string(no_object));
        }
        if (!join && pair.b < pair.a) std::swap(pair.a, pair.b);
    }
    return std::make_unique<IgnoredPairsFilter>(ignored);
}

std::unique_ptr<Filter> make_parent_filter(std::span<const std::uint32_t> parents,
                                           std::optional<std::span<const std::uint32_t>> second) {
    return std::make_unique<ParentFilter>(PerObject<std::uint32_t>("parent", parents, second));
}

}  // namespace octopair
