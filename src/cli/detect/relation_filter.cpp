#include "cli/detect/relation_filter.hpp"

#include <algorithm>
#include <array>
#include <string_view>
#include <utility>

#include <fmt/format.h>

namespace octopair::cli {

namespace {

using io::Link;
using io::Relation;

/// Maximum length of a chain of wholes, or of hosts. Bounds the time for files whose chains are circles.
constexpr std::size_t longest_chain = 64;

/// Links, sorted.
class LinkTable {
public:
    LinkTable() = default;
    explicit LinkTable(std::vector<Link> links) : links_(std::move(links)) {
        std::ranges::sort(links_, less);
        links_.erase(std::unique(links_.begin(), links_.end()), links_.end());
    }

    std::span<const Link> all() const { return links_; }
    std::span<const Link> from(std::uint32_t key) const {
        const auto [begin, end] =
            std::ranges::equal_range(links_, key, std::less<>(), [](const Link& link) { return link.from; });
        return {begin, end};
    }
    bool contains(std::uint32_t from, std::uint32_t to) const {
        return std::ranges::binary_search(links_, Link{from, to}, less);
    }

private:
    static bool less(const Link& a, const Link& b) { return std::pair(a.from, a.to) < std::pair(b.from, b.to); }

    std::vector<Link> links_;
};

/// The wholes of each element.
class Wholes {
public:
    Wholes(std::size_t keys, std::span<const Link> parts) : whole_(keys) {
        for (const auto& [part, whole] : parts) {
            if (whole_[part] == 0 && part != whole) whole_[part] = whole;
        }
    }

    /// Calls visit(key) for an element and for its wholes, up to the outermost one, until visit returns true. Returns whether it did.
    template <typename Visit>
    bool any_of(std::uint32_t element, const Visit& visit) const {
        for (std::size_t i = 0; element != 0 && i < longest_chain; ++i, element = whole_[element]) {
            if (visit(element)) return true;
        }
        return false;
    }
    std::uint32_t outermost(std::uint32_t element) const {
        std::uint32_t last = element;
        (void)any_of(element, [&](std::uint32_t key) {
            last = key;
            return false;
        });
        return last;
    }

private:
    std::vector<std::uint32_t> whole_;  // 0: no part of an element
};

/// The elements whose openings each element fills.
class Openings {
public:
    Openings(const LinkTable& fills, const Wholes& wholes) : wholes_(wholes) {
        std::vector<Link> hosts, above;
        std::uint32_t last = 0;
        for (const Link& link : fills.all()) {
            if (std::exchange(last, link.from) == link.from) continue;
            const std::size_t first = hosts.size();
            for (const Link& own : fills.from(link.from)) hosts.push_back(own);
            for (std::size_t i = first; i < hosts.size() && i < first + longest_chain; ++i) {
                const std::uint32_t host = hosts[i].to;
                for (const Link& next : fills.from(host)) hosts.push_back({link.from, next.to});
                (void)wholes.any_of(host, [&](std::uint32_t whole) {
                    above.push_back({link.from, whole});
                    return false;
                });
            }
        }
        hosts_ = LinkTable(std::move(hosts));
        wholes_of_hosts_ = LinkTable(std::move(above));
    }

    /// Returns whether `filler` fills an opening of `host`.
    bool fills(std::uint32_t filler, std::uint32_t host) const {
        return wholes_.any_of(filler, [&](std::uint32_t by) {
            if (wholes_of_hosts_.contains(by, host)) return true;
            return wholes_.any_of(host, [&](std::uint32_t in) { return hosts_.contains(by, in); });
        });
    }

private:
    const Wholes& wholes_;
    LinkTable hosts_;            // the hosts, and what these are in
    LinkTable wholes_of_hosts_;  // the wholes that the hosts are parts of
};

bool have_common(std::span<const Link> first, std::span<const Link> second) {
    auto i = first.begin();
    auto j = second.begin();
    while (i != first.end() && j != second.end()) {
        if (i->to == j->to) return true;
        i->to < j->to ? ++i : ++j;
    }
    return false;
}

class RelationFilter final : public Filter {
public:
    RelationFilter(io::ObjectRelations relations, std::size_t first_of_second, std::span<const io::RelationRule> rules)
        : elements_(std::move(relations.elements)),
          first_of_second_(first_of_second),
          wholes_(relations.keys.size(), links_of(relations, Relation::assembly)),
          openings_(LinkTable(links_of(relations, Relation::fills)), wholes_),
          systems_(links_of(relations, Relation::system)) {
        for (const io::RelationRule& rule : rules) drops_[std::size_t(rule.relation)] = true;
    }

    std::string_view name() const override { return "relation rules"; }
    void apply(Batch& batch) const override {
        batch.keep_if([&](std::size_t i) {
            const Pair pair = batch.pairs()[i];
            const std::uint32_t a = elements_[pair.a], b = elements_[first_of_second_ + pair.b];
            return a == 0 || b == 0 || a == b || !are_related(a, b);
        });
    }

private:
    static std::vector<Link> links_of(const io::ObjectRelations& relations, Relation relation) {
        return relations.links[std::size_t(relation)];
    }

    bool are_related(std::uint32_t a, std::uint32_t b) const {
        const auto drops = [&](Relation relation) { return drops_[std::size_t(relation)]; };
        return (drops(Relation::fills) && (openings_.fills(a, b) || openings_.fills(b, a))) ||
               (drops(Relation::assembly) && wholes_.outermost(a) == wholes_.outermost(b)) ||
               (drops(Relation::system) && share_system(a, b));
    }
    bool share_system(std::uint32_t a, std::uint32_t b) const {
        return wholes_.any_of(a, [&](std::uint32_t of_a) {
            const std::span<const Link> own = systems_.from(of_a);
            return !own.empty() &&
                   wholes_.any_of(b, [&](std::uint32_t of_b) { return have_common(own, systems_.from(of_b)); });
        });
    }

    std::vector<std::uint32_t> elements_;  // of the objects of both sets; 0: no element
    std::size_t first_of_second_;
    Wholes wholes_;
    Openings openings_;
    LinkTable systems_;
    std::array<bool, io::all_relations.size()> drops_ = {};
};

/// Returns what a relation says, for messages.
std::string_view meaning_of(Relation relation) {
    switch (relation) {
        case Relation::fills:
            return "fills an opening of another (IfcRelFillsElement)";
        case Relation::assembly:
            return "is part of another (IfcRelAggregates)";
        case Relation::system:
            break;
    }
    return "is in a system (IfcSystem, IfcRelAssignsToGroup)";
}

}  // namespace

std::unique_ptr<Filter> make_relation_filter(std::span<const io::RelationRule> rules, const SetPair& sets) {
    const std::size_t first = sets.first.scene.objects;
    io::ObjectRelations relations = sets.first.scene.relations;
    if (sets.second != nullptr)
        append_relations(relations, sets.second->scene.relations, {first, std::size_t(sets.second->scene.objects)});
    relations.elements.resize(first + (sets.second != nullptr ? sets.second->scene.objects : 0));
    return std::make_unique<RelationFilter>(std::move(relations), sets.second != nullptr ? first : 0, rules);
}

std::vector<std::string> relation_warnings(std::span<const io::RelationRule> rules, const SetPair& sets) {
    std::vector<std::string> warnings;
    for (const io::RelationRule& rule : rules) {
        const auto has = [&](const InputSet* set) {
            return set != nullptr && !set->scene.relations.links[std::size_t(rule.relation)].empty();
        };
        if (has(&sets.first) || has(sets.second)) continue;
        warnings.push_back(fmt::format("{}: no element of the inputs {}; the rule '{}' leaves out nothing", rule.place,
                                       meaning_of(rule.relation), word_of(rule.relation)));
    }
    return warnings;
}

}  // namespace octopair::cli
