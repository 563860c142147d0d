#include "io/meshes/assimp/ifc_links.hpp"

#include <algorithm>
#include <array>
#include <span>

namespace octopair::io {

namespace {

constexpr std::array<std::string_view, 18> place_types = {"IFCPROJECT",
                                                          "IFCSITE",
                                                          "IFCBUILDING",
                                                          "IFCBUILDINGSTOREY",
                                                          "IFCSPACE",
                                                          "IFCSPATIALZONE",
                                                          "IFCEXTERNALSPATIALELEMENT",
                                                          "IFCFACILITY",
                                                          "IFCFACILITYPART",
                                                          "IFCFACILITYPARTCOMMON",
                                                          "IFCBRIDGE",
                                                          "IFCBRIDGEPART",
                                                          "IFCROAD",
                                                          "IFCROADPART",
                                                          "IFCRAILWAY",
                                                          "IFCRAILWAYPART",
                                                          "IFCMARINEFACILITY",
                                                          "IFCMARINEPART"};
constexpr std::array<std::string_view, 7> system_types = {
    "IFCSYSTEM",         "IFCDISTRIBUTIONSYSTEM", "IFCDISTRIBUTIONCIRCUIT",    "IFCELECTRICALCIRCUIT",
    "IFCBUILDINGSYSTEM", "IFCBUILTSYSTEM",        "IFCSTRUCTURALANALYSISMODEL"};

bool is_any_of(const step::StepInstance& instance, std::span<const std::string_view> types) {
    return std::any_of(types.begin(), types.end(), [&](std::string_view type) { return instance.is(type); });
}

/// Returns the numbers of the instances that a relation refers to, without that of its owner history, its second attribute.
std::vector<std::string_view> related(const step::StepInstance& instance) {
    std::vector<std::string_view> numbers = step::references_of(instance.attributes);
    if (!numbers.empty() && step::attribute_at(instance, 1).starts_with('#')) numbers.erase(numbers.begin());
    return numbers;
}

}  // namespace

void IfcLinkReader::add(const step::StepInstance& instance) {
    if (is_any_of(instance, place_types)) places_.insert(instance.number);
    if (is_any_of(instance, system_types)) systems_.insert(instance.number);
    if (!instance.is("IFCREL", true)) return;
    const bool voids = instance.is("IFCRELVOIDSELEMENT"), fills = instance.is("IFCRELFILLSELEMENT");
    const bool aggregates = instance.is("IFCRELAGGREGATES"), assigns = instance.is("IFCRELASSIGNSTOGROUP", true);
    if (!voids && !fills && !aggregates && !assigns) return;
    const std::vector<std::string_view> numbers = related(instance);
    if (numbers.size() < 2) return;
    if (voids) hosts_.emplace(numbers[1], numbers[0]);
    if (fills) fills_.push_back({numbers[1], numbers[0]});
    if (aggregates) {
        for (std::size_t i = 1; i < numbers.size(); ++i) parts_.push_back({numbers[i], numbers[0]});
    }
    if (assigns) {
        for (std::size_t i = 0; i + 1 < numbers.size(); ++i) members_.push_back({numbers[i], numbers.back()});
    }
}

IfcLinks IfcLinkReader::find(const IfcIds& ids) const {
    IfcLinks links;
    const auto link = [&](Relation relation, std::string_view from, std::string_view to) {
        const auto a = ids.find(from), b = ids.find(to);
        if (a == ids.end() || b == ids.end()) return;
        links[std::size_t(relation)].push_back({std::string(a->second), std::string(b->second)});
    };
    for (const auto& [filler, opening] : fills_) {
        const auto host = hosts_.find(opening);
        if (host != hosts_.end()) link(Relation::fills, filler, host->second);
    }
    for (const auto& [part, whole] : parts_) {
        if (!places_.contains(whole)) link(Relation::assembly, part, whole);
    }
    for (const auto& [member, group] : members_) {
        if (systems_.contains(group)) link(Relation::system, member, group);
    }
    return links;
}

}  // namespace octopair::io
