#include "engine/threads/octant_lists.hpp"

#include <algorithm>
#include <array>
#include <cfloat>
#include <memory>
#include <new>
#include <utility>

#include "base/floating_point_scope.hpp"
#include "base/stop.hpp"
#include "boxes/box_source.hpp"
#include "engine/request.hpp"
#include "engine/threads/team_output.hpp"
#include "octopair/error.hpp"
#include "octree/build/linear_octree.hpp"

namespace octopair {

namespace {

constexpr std::size_t octants_per_share = 64;

/// Converts cells to coordinates of the caller.
class CellFaces {
public:
    CellFaces(const Space& space, const BoxSource& source) : map_(space.map()) {
        if (!source.exact()) origin_ = source.rounding().origin;
    }
    /// Returns the coordinate at which the cell begins, half a fine cell lower because the map rounds to the nearest fine cell. Monotone: a
    /// greater cell never gets a smaller coordinate.
    double face(std::uint32_t cell, unsigned axis) const {
        constexpr auto largest = double(FLT_MAX);
        const double fine = double(std::uint64_t(cell) << SpaceMap::fine_bits) - 0.5;
        // Limits the offset to FLT_MAX: in the map, a greater difference overflows and gets the last cell, so no cell begins there.
        const double offset = std::min(fine / double(map_.scale[axis]), largest);
        return origin_[axis] + std::clamp(double(map_.origin[axis]) + offset, -largest, largest);
    }

private:
    const SpaceMap& map_;
    std::array<double, 4> origin_ = {0, 0, 0, 0};
};

/// Copies an octree to lists, octant by octant.
class OctantCopier {
public:
    OctantCopier(const LinearOctree& octree, const BoxSource& source, const ListedObjects& listed,
                 detail::OctantLists& lists)
        : octree_(octree), faces_(octree.space(), source), numbers_(listed.numbers), lists_(lists) {
        const std::size_t octants = octree.octants().size();
        lists_.octants.resize(octants);
        lists_.begins.resize(octants + 1);
        for (OctantIndex octant = 0; octant <= octants; ++octant) {
            lists_.begins[octant] = octree.entry_count(0, octant);
        }
        lists_.objects.resize(std::size_t(octree.entry_count()));
        lists_.homes.assign(std::size_t(listed.numbers_end), Octants::no_octant);
        for (unsigned axis = 0; axis < 3; ++axis) {
            lists_.space.min[axis] = faces_.face(0, axis);
            lists_.space.max[axis] = faces_.face(octree.space().last_cell(axis) + 1, axis);
        }
    }

    /// Copies one octant. Thread safety: several threads may copy different octants.
    void copy(OctantIndex index) const {
        const Octant& octant = octree_.octants()[index];
        OctantSummary& summary = lists_.octants[index];
        summary.code = octant.code();
        summary.leaf = octant.leaf();
        summary.entries = octree_.entry_count(index);
        for (unsigned axis = 0; axis < 3; ++axis) {
            summary.bounds.min[axis] = faces_.face(octant.lo[axis], axis);
            summary.bounds.max[axis] = faces_.face(octant.lo[axis] + (cells_per_axis >> octant.level), axis);
        }
        summary.homes = copy_objects(index);
    }

private:
    /// Copies the objects of an octant, homes first. Returns the number of homes.
    std::uint64_t copy_objects(OctantIndex octant) const {
        std::uint32_t* const begin = lists_.objects.data() + lists_.begins[octant];
        std::uint32_t* out = begin;
        octree_.for_each_run(octant, [&](std::span<const CellEntry> run) {
            for (const CellEntry& entry : run) {
                if (!has_no_class_bit(entry)) continue;
                *out = number(entry.object);
                lists_.homes[*out++] = octant;
            }
        });
        const auto homes = std::uint64_t(out - begin);
        if (homes == octree_.entry_count(octant)) return homes;
        octree_.for_each_run(octant, [&](std::span<const CellEntry> run) {
            for (const CellEntry& entry : run) {
                if (!has_no_class_bit(entry)) *out++ = number(entry.object);
            }
        });
        return homes;
    }
    std::uint32_t number(std::uint32_t position) const { return numbers_.empty() ? position : numbers_[position]; }

    const LinearOctree& octree_;
    CellFaces faces_;
    std::span<const std::uint32_t> numbers_;
    detail::OctantLists& lists_;
};

std::shared_ptr<const detail::OctantLists> lists_of(const ListedObjects& listed, Team& team,
                                                    const std::stop_token& stop) {
    throw_if_stopped(stop);
    const BoxSource source(listed.objects, nullptr, listed.margin);
    TeamExecutor executor(team);
    LinearOctree octree;
    try {
        octree.build(source, executor, stop);
    } catch (const LinearOctree::Invalid& invalid) {
        source.refuse(invalid.begin);
    }
    auto lists = std::make_shared<detail::OctantLists>();
    const OctantCopier copier(octree, source, listed, *lists);
    const std::size_t octants = octree.octants().size();
    executor.for_each((octants + octants_per_share - 1) / octants_per_share, [&](std::size_t share) {
        throw_if_stopped(stop);
        const std::size_t end = std::min(octants, (share + 1) * octants_per_share);
        for (std::size_t octant = share * octants_per_share; octant < end; ++octant) {
            copier.copy(OctantIndex(octant));
        }
    });
    return lists;
}

}  // namespace

Octants detail::make_octants(std::shared_ptr<const OctantLists> lists) noexcept {
    Octants octants;
    octants.lists_ = std::move(lists);
    return octants;
}

Octants::Octants() noexcept = default;
Octants::Octants(const Octants&) noexcept = default;
Octants::Octants(Octants&&) noexcept = default;
Octants& Octants::operator=(const Octants&) noexcept = default;
Octants& Octants::operator=(Octants&&) noexcept = default;
Octants::~Octants() = default;

std::span<const OctantSummary> Octants::all() const noexcept {
    if (lists_ == nullptr) return {};
    return lists_->octants;
}

std::span<const std::uint32_t> Octants::objects(std::size_t octant) const noexcept {
    const std::uint64_t begin = lists_->begins[octant], end = lists_->begins[octant + 1];
    return std::span(lists_->objects).subspan(std::size_t(begin), std::size_t(end - begin));
}

std::span<const std::uint32_t> Octants::home_octants() const noexcept {
    if (lists_ == nullptr) return {};
    return lists_->homes;
}

std::vector<std::uint8_t> Octants::levels() const {
    std::vector<std::uint8_t> levels;
    levels.reserve(home_octants().size());
    for (const std::uint32_t home : home_octants()) {
        levels.push_back(home == no_octant ? no_level : std::uint8_t(lists_->octants[home].code.level()));
    }
    return levels;
}

Box3d Octants::space() const noexcept { return lists_ != nullptr ? lists_->space : Box3d{}; }

Octants copy_octants(const ListedObjects& listed, Team& team, const std::stop_token& stop) {
    try {
        return detail::make_octants(lists_of(listed, team, stop));
    } catch (const std::bad_alloc&) {
        throw Error(ErrorCode::resource_limit, "out of memory");
    }
}

Octants list_octants(const Objects& objects, const OctantOptions& options, std::stop_token stop) {
    const FloatingPointScope scope;
    Options checked;
    checked.margin = options.margin;
    detail::check_request({objects, nullptr, checked});
    Team team(options.threads);
    return copy_octants({objects, options.margin, objects.size()}, team, stop);
}

}  // namespace octopair
