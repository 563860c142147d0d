#include "cli/input/placement.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>
#include <variant>

#include <fmt/format.h>

namespace octopair::cli {

namespace {

/// An input with its box, and the number of its set.
struct PlacedPart {
    const Part* part;
    Box3d box;
    int set;
};

Box3d bounds_of(const InputSet& set, std::uint64_t first, std::uint64_t count) {
    constexpr double infinity = std::numeric_limits<double>::infinity();
    Box3d bounds{{infinity, infinity, infinity}, {-infinity, -infinity, -infinity}};
    std::visit(
        [&](const auto& boxes) {
            for (const auto& box : boxes.span().subspan(std::size_t(first), std::size_t(count))) {
                for (std::size_t axis = 0; axis < 3; ++axis) {
                    bounds.min[axis] = std::min(bounds.min[axis], double(box.min[axis]));
                    bounds.max[axis] = std::max(bounds.max[axis], double(box.max[axis]));
                }
            }
        },
        set.scene.boxes);
    return bounds;
}

void add_models(const InputSet& set, int number, std::vector<PlacedPart>& models) {
    std::uint64_t first = 0;
    for (const Part& part : set.parts) {
        if (part.is_model && part.objects > 0) models.push_back({&part, bounds_of(set, first, part.objects), number});
        first += part.objects;
    }
}

double distance_of(const Box3d& a, const Box3d& b) {
    std::array<double, 3> gaps;
    for (std::size_t axis = 0; axis < 3; ++axis)
        gaps[axis] = std::max({a.min[axis] - b.max[axis], b.min[axis] - a.max[axis], 0.0});
    return std::hypot(gaps[0], gaps[1], gaps[2]);
}

std::string corner_of(const Box3d& box) {
    return fmt::format("{:.6g} {:.6g} {:.6g}", box.min[0], box.min[1], box.min[2]);
}

/// Returns the model nearest to `model` among those that it may collide with, and the distance.
std::pair<const PlacedPart*, double> nearest(const PlacedPart& model, const std::vector<PlacedPart>& models,
                                             bool join) {
    std::pair<const PlacedPart*, double> nearest = {nullptr, std::numeric_limits<double>::infinity()};
    for (const PlacedPart& other : models) {
        if (&other == &model || (join && other.set == model.set)) continue;
        const double distance = distance_of(model.box, other.box);
        if (distance < nearest.second) nearest = {&other, distance};
    }
    return nearest;
}

/// Returns a warning if a model meets no other model, or an empty text.
std::string apart_warning(const std::vector<PlacedPart>& models, const SetPair& sets, double margin) {
    std::string text;
    std::size_t apart = 0;
    for (const PlacedPart& model : models) {
        const auto [other, distance] = nearest(model, models, sets.second != nullptr);
        if (other == nullptr || distance <= margin || ++apart > 1) continue;
        const std::string& unit = sets.first.scene.space.unit;
        text = fmt::format(
            "{} and {} do not meet: they are {:.6g}{}{} apart. The box of the first begins at {}, that of the second "
            "at "
            "{}; check that both are exported with the same origin and the same unit",
            model.part->path, other->part->path, distance, unit.empty() ? "" : " ", unit, corner_of(model.box),
            corner_of(other->box));
    }
    // With two models, one warning is enough: each is apart from the other.
    if (apart > 2 || (apart > 1 && models.size() > 2)) text += fmt::format(". {} inputs meet no other", apart);
    return text;
}

/// Returns a warning about inputs that state no unit although others do, or an empty text.
std::string unit_warning(const SetPair& sets) {
    const Part *with = nullptr, *without = nullptr;
    std::size_t count = 0;
    for (const InputSet* set : {&sets.first, sets.second}) {
        if (set == nullptr) continue;
        for (const Part& part : set->parts) {
            if (!part.unit.empty()) {
                if (with == nullptr) with = &part;
            } else if (++count == 1) {
                without = &part;
            }
        }
    }
    if (with == nullptr || without == nullptr) return {};
    const std::string& unit = sets.first.scene.space.unit.empty() ? with->unit : sets.first.scene.space.unit;
    const std::string more = count == 1 ? "" : fmt::format(" and {} more", count - 1);
    return fmt::format("{}{}: no unit is stated; coordinates count as {}, the unit of {}", without->path, more, unit,
                       with->path);
}

}  // namespace

void add_placement_warnings(const SetPair& sets, double margin, std::vector<std::string>& warnings) {
    std::vector<PlacedPart> models;
    if (sets.first.parts.size() + (sets.second != nullptr ? sets.second->parts.size() : 0) > 1) {
        add_models(sets.first, 0, models);
        if (sets.second != nullptr) add_models(*sets.second, 1, models);
    }
    for (const std::string& warning : {unit_warning(sets), apart_warning(models, sets, margin)}) {
        if (!warning.empty()) warnings.push_back(warning);
    }
}

}  // namespace octopair::cli
