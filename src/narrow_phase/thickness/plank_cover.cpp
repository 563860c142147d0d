#include "narrow_phase/thickness/plank_cover.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <optional>
#include <utility>

namespace octopair {

namespace {

constexpr std::size_t max_planks = 6;  // that a search proposes
constexpr int max_widenings = 8;
constexpr double unlimited = std::numeric_limits<double>::infinity();

// Proposals: planks that cover the pieces.

/// Returns the plank along the mean normal of the pieces, those of b turned around: the way that a moves out of b, if all pieces agree.
std::optional<Plank> single_plank(std::span<const Piece> pieces) {
    Point3d sum = {};
    double area = 0;
    for (const Piece& piece : pieces) {
        sum = vector::plus(sum, vector::times(piece.normal, piece.side == 0 ? piece.area : -piece.area));
        area += piece.area;
    }
    const auto normal = area > 0 ? direction_of(vector::times(sum, 1 / area)) : std::nullopt;
    if (!normal) return std::nullopt;
    Plank plank{*normal, {unlimited, -unlimited}};
    for (const Piece& piece : pieces) plank = plank.widened(extent_along(*normal, piece.polygon));
    return plank;
}

/// Finds planks along one normal after the other.
class PlankSearch {
public:
    /// `parallel`: the least cosine of the normals of two pieces for one plank.
    PlankSearch(const CoverRequest& request, double parallel) : request_(request), parallel_(parallel) {
        for (const Piece& piece : request.pieces) waiting_.push_back(&piece);
        std::sort(waiting_.begin(), waiting_.end(), [](const Piece* x, const Piece* y) { return x->area > y->area; });
    }

    std::optional<std::vector<Plank>> run() {
        while (!waiting_.empty()) {
            std::vector<Plank> thin = thin_planks(waiting_.front()->normal);
            join_where_solid(thin);
            planks_.insert(planks_.end(), thin.begin(), thin.end());
            if (planks_.size() > max_planks) return std::nullopt;
            std::erase_if(waiting_, [&](const Piece* piece) {
                const Extent extent = extent_along(thin.front().normal, piece->polygon);
                return std::any_of(thin.begin(), thin.end(),
                                   [&](const Plank& plank) { return plank.covers(extent, rounding()); });
            });
        }
        return planks_;
    }

private:
    double rounding() const { return request_.surface.rounding(); }

    /// Returns the thinnest planks that cover the waiting pieces parallel to `normal`, in ascending order.
    std::vector<Plank> thin_planks(const Point3d& normal) const {
        std::vector<Extent> extents;
        for (const Piece* piece : waiting_) {
            if (std::abs(vector::dot(piece->normal, normal)) < parallel_) continue;
            extents.push_back(extent_along(normal, piece->polygon));
        }
        std::sort(extents.begin(), extents.end(), [](const Extent& x, const Extent& y) { return x.low < y.low; });
        std::vector<Plank> planks;
        for (const Extent& extent : extents) {
            if (planks.empty() || extent.low > planks.back().extent.high + rounding()) {
                planks.push_back({normal, extent});
            } else {
                planks.back() = planks.back().widened(extent);
            }
        }
        return planks;
    }

    /// Joins neighbouring planks if the gap between them is narrow, and a point of it lies in both solids.
    void join_where_solid(std::vector<Plank>& planks) const {
        for (std::size_t i = 0; i + 1 < planks.size();) {
            if (planks[i + 1].extent.high - planks[i].extent.low > request_.most ||
                !is_solid_between(planks[i], planks[i + 1])) {
                ++i;
                continue;
            }
            planks[i] = planks[i].widened(planks[i + 1].extent);
            planks.erase(planks.begin() + std::ptrdiff_t(i) + 1);
        }
    }

    bool is_solid_between(const Plank& low, const Plank& high) const {
        const double between = low.extent.high / 2 + high.extent.low / 2;
        return std::any_of(waiting_.begin(), waiting_.end(), [&](const Piece* piece) {
            if (!low.covers(extent_along(low.normal, piece->polygon), rounding())) return false;
            const Point3d middle = middle_of(piece->polygon);
            const double up = between - vector::dot(low.normal, middle);
            return request_.surface.in_both(vector::plus(middle, vector::times(low.normal, up)));
        });
    }

    const CoverRequest& request_;
    double parallel_;
    std::vector<const Piece*> waiting_;  // not covered yet, by descending area
    std::vector<Plank> planks_;
};

// Tests of proposals.

class CoverTest {
public:
    CoverTest(const CoverRequest& request, Cover& cover) : request_(request), cover_(cover) {}

    /// Returns true if the planks, some of them widened, are a cover.
    bool run(std::vector<Plank> planks) {
        if (width_of(planks) > request_.most) return false;
        if (domain_.empty()) domain_ = Polyhedron(request_.domain, rounding());
        for (int i = 0; width_of(planks) <= request_.most && i <= max_widenings; ++i) {
            const bool clear = visit_regions(domain_, planks, rounding(), [&](const Polyhedron& region) {
                const Point3d middle = region.middle();
                if (!request_.surface.in_both(middle)) return true;
                cover_.in_both.push_back(middle);
                widen_nearest(planks, region);
                return false;
            });
            if (!clear) continue;
            cover_.width = width_of(planks);
            cover_.planks = std::move(planks);
            return true;
        }
        return false;
    }

private:
    double rounding() const { return request_.surface.rounding(); }

    static double width_of(const std::vector<Plank>& planks) {
        double sum = 0;
        for (const Plank& plank : planks) sum += plank.width();
        return sum;
    }

    /// Widens the plank that needs the least for it, so that it covers the region.
    static void widen_nearest(std::vector<Plank>& planks, const Polyhedron& region) {
        Plank* nearest = nullptr;
        double least = unlimited;
        for (Plank& plank : planks) {
            const double more = plank.widened(region.along(plank.normal)).width() - plank.width();
            if (more < least) least = more, nearest = &plank;
        }
        if (nearest != nullptr) *nearest = nearest->widened(region.along(nearest->normal));
    }

    const CoverRequest& request_;
    Cover& cover_;
    Polyhedron domain_;  // empty before the first test
};

}  // namespace

std::vector<Cover> find_covers(const CoverRequest& request) {
    std::vector<Cover> covers;
    const auto test = [&](std::vector<Plank> planks) {
        Cover& cover = covers.emplace_back();
        cover.found = CoverTest(request, cover).run(std::move(planks));
    };
    if (request.pieces.empty()) {
        test({});
        return covers;
    }
    if (const auto plank = single_plank(request.pieces)) test({*plank});
    for (const double parallel : {0.9, 0.999}) {
        if (auto planks = PlankSearch(request, parallel).run()) test(std::move(*planks));
    }
    return covers;
}

}  // namespace octopair
