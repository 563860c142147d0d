#include "narrow_phase/thickness/plank_cover.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <optional>

namespace octopair {

namespace {

constexpr std::size_t max_planks = 6;        // that a search proposes
constexpr std::size_t max_open_planks = 32;  // with those that are added so that all open
constexpr int max_widenings = 8;
constexpr double facing = 1e-6;  // cosine: pieces that are closer to perpendicular face neither way
constexpr double infinity = std::numeric_limits<double>::infinity();

std::optional<Point3d> unit(const Point3d& direction) {
    const double length = vector::length(direction);
    if (!(length > 1e-3)) return std::nullopt;
    return vector::times(direction, 1 / length);
}

// Proposals: planks that cover the pieces.

/// Returns the plank along the mean normal of the pieces, those of b turned around: the way that a moves out of b, if all pieces agree.
std::optional<Plank> single_plank(std::span<const Piece> pieces) {
    Point3d sum = {};
    double area = 0;
    for (const Piece& piece : pieces) {
        sum = vector::plus(sum, vector::times(piece.normal, piece.side == 0 ? piece.area : -piece.area));
        area += piece.area;
    }
    const auto normal = area > 0 ? unit(vector::times(sum, 1 / area)) : std::nullopt;
    if (!normal) return std::nullopt;
    Plank plank{*normal, {infinity, -infinity}};
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

/// Says which way a piece faces along a direction: 1 along it, -1 against it, 0 neither. A piece of a mesh without one orientation is
/// tested at points on both sides of `middle`, a point of the piece; nothing if the solid is on both sides of it, or on none.
std::optional<int> way_of(const OverlapSurface& surface, const Piece& piece, const Point3d& middle,
                          const Point3d& direction) {
    const double cosine = vector::dot(piece.normal, direction);
    if (std::abs(cosine) <= facing) return 0;
    const int way = cosine > 0 ? 1 : -1;
    if (surface.oriented(piece.side)) return way;
    const Point3d step = vector::times(piece.normal, 1024 * surface.rounding());
    const bool before = surface.in_solid(piece.side, vector::minus(middle, step));
    const bool behind = surface.in_solid(piece.side, vector::plus(middle, step));
    if (before == behind) return std::nullopt;
    return before ? way : -way;
}

/// Part of a piece in a plank.
struct PlankPart {
    Polygon polygon;
    Point3d normal;  ///< points out of the solid
};

/// The parts in a plank that face along its normal, and those that face against it, of each solid.
struct FacingParts {
    std::array<std::vector<PlankPart>, 2> along, against;
};

/// A plank, and regions of it that it should open. `normals`: sum of the normals of the parts that other planks do not open there.
struct PlankTask {
    Plank plank;
    std::vector<Polyhedron> regions;
    Point3d normals = {};
};

/// Appends the planes of the prism above and below a polygon, along `direction`.
void append_prism(const Polygon& polygon, const Point3d& direction, std::vector<CutPlane>& planes) {
    const Point3d middle = middle_of(polygon);
    for (std::size_t i = 0; i < polygon.corners.size(); ++i) {
        const Point3d &from = polygon.corners[i], &to = polygon.corners[(i + 1) % polygon.corners.size()];
        const Point3d outward = vector::cross(vector::minus(to, from), direction);
        const double length = vector::length(outward);
        if (!(length > 0)) continue;
        const double sense = vector::dot(outward, vector::minus(middle, from)) > 0 ? -1 : 1;
        const Point3d normal = vector::times(outward, sense / length);
        planes.push_back({normal, vector::dot(normal, from)});
    }
}

CutPlane plane_above(const PlankPart& part) { return {part.normal, vector::dot(part.normal, part.polygon.corners[0])}; }

/// Returns whether a line along `normal` enters the solid at `below` and leaves it at `above`.
bool are_facing(const PlankPart& above, const PlankPart& below, const Point3d& normal, double rounding) {
    std::vector<CutPlane> planes;
    append_prism(below.polygon, normal, planes);
    Polygon common = above.polygon;
    for (const CutPlane& plane : planes) {
        common = split(common, plane, rounding).below;
        if (common.empty() || extent_along(plane.normal, common).low > plane.offset - rounding) return false;
    }
    const Point3d up = vector::minus(middle_of(common), below.polygon.corners[0]);
    return vector::dot(below.normal, up) < -rounding;
}

/// Returns the part of a region on lines along `normal` that enter the solid at `below` and leave it at `above`; empty if it has no interior.
Polyhedron pierced_region(Polyhedron region, const PlankPart& above, const PlankPart& below, const Plank& plank,
                          double rounding) {
    std::vector<CutPlane> planes = {plane_above(above), plane_above(below)};
    append_prism(above.polygon, plank.normal, planes);
    append_prism(below.polygon, plank.normal, planes);
    region.cut_to(planes, rounding);
    return region;
}

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
            return open(planks);
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
        double least = infinity;
        for (Plank& plank : planks) {
            const double more = plank.widened(region.along(plank.normal)).width() - plank.width();
            if (more < least) least = more, nearest = &plank;
        }
        if (nearest != nullptr) *nearest = nearest->widened(region.along(nearest->normal));
    }

    /// Returns whether each point in the planks lies in a plank that opens there, and is at most as wide as the tolerance. Uses further planks where
    /// the given ones do not open.
    bool open(const std::vector<Plank>& planks) const {
        std::vector<PlankTask> waiting;
        for (const Plank& plank : planks) waiting.push_back({plank, {domain_}});
        for (std::size_t i = 0; i < waiting.size(); ++i) {
            const PlankTask task = waiting[i];
            if (task.plank.width() > request_.most || i == max_open_planks) return false;
            const auto parts = facing_parts(task.plank);
            if (!parts) return false;
            std::vector<PlankTask> added;
            for (const std::size_t side : {0U, 1U}) {
                for (const PlankPart& above : parts->along[side]) {
                    for (const PlankPart& below : parts->against[side]) {
                        if (!open_between(task, above, below, added)) return false;
                    }
                }
            }
            waiting.insert(waiting.end(), added.begin(), added.end());
        }
        return true;
    }

    /// Adds planks for the regions of a task that are pierced between two parts. Returns false if the parts face exactly opposite ways.
    bool open_between(const PlankTask& task, const PlankPart& above, const PlankPart& below,
                      std::vector<PlankTask>& added) const {
        if (!are_facing(above, below, task.plank.normal, rounding())) return true;
        for (const Polyhedron& whole : task.regions) {
            Polyhedron region = pierced_region(whole, above, below, task.plank, rounding());
            if (region.empty()) continue;
            const Point3d normals = vector::plus(task.normals, vector::plus(above.normal, below.normal));
            const auto way = unit(normals);
            if (!way) return false;
            const Plank plank{*way, region.along(*way)};
            const auto same = std::find_if(added.begin(), added.end(), [&](const PlankTask& other) {
                return vector::dot(other.plank.normal, *way) > 1 - 1e-9;
            });
            if (same == added.end()) {
                added.push_back({plank, {std::move(region)}, normals});
            } else {
                same->plank = same->plank.widened(plank.extent);
                same->regions.push_back(std::move(region));
            }
        }
        return true;
    }

    /// Returns the parts in a plank that face along its normal or against it; nothing if one faces both ways.
    std::optional<FacingParts> facing_parts(const Plank& plank) const {
        FacingParts parts;
        for (const Piece& piece : request_.pieces) {
            const Polygon low_part = split(piece.polygon, {plank.normal, plank.extent.high}, rounding()).below;
            Polygon part = split(low_part, {vector::times(plank.normal, -1), -plank.extent.low}, rounding()).below;
            if (part.empty()) continue;
            const auto way = way_of(request_.surface, piece, middle_of(part), plank.normal);
            if (!way) return std::nullopt;
            if (*way == 0) continue;
            const bool outward = (*way > 0) == (vector::dot(piece.normal, plank.normal) > 0);
            auto& list = *way > 0 ? parts.along : parts.against;
            list[piece.side].push_back({std::move(part), outward ? piece.normal : vector::times(piece.normal, -1)});
        }
        return parts;
    }

    const CoverRequest& request_;
    Cover& cover_;
    Polyhedron domain_;  // empty before the first test
};

/// Returns how far above `from` the line along `direction` meets the piece; nothing if it does not.
std::optional<double> height_along(const Piece& piece, const Point3d& from, const Point3d& direction) {
    const double slope = vector::dot(piece.normal, direction);
    const double height = vector::dot(piece.normal, vector::minus(piece.polygon.corners[0], from)) / slope;
    if (!std::isfinite(height)) return std::nullopt;
    const Point3d at = vector::plus(from, vector::times(direction, height));
    double sense = 0;
    for (std::size_t i = 0; i < piece.polygon.corners.size(); ++i) {
        const Point3d &p = piece.polygon.corners[i], &q = piece.polygon.corners[(i + 1) % piece.polygon.corners.size()];
        const double side = vector::dot(piece.normal, vector::cross(vector::minus(q, p), vector::minus(at, p)));
        if (side * sense < 0) return std::nullopt;
        if (side != 0) sense = side;
    }
    return height;
}

}  // namespace

bool is_pierced(const CoverRequest& request, const Box3d& box) {
    constexpr double opposite = -0.999;  // cosine
    const auto& pieces = request.pieces;
    const auto of_one_solid = [&](const Piece& piece) { return piece.side == pieces.front().side; };
    if (pieces.empty() || !std::all_of(pieces.begin(), pieces.end(), of_one_solid)) return false;
    const Point3d middle = middle_of(box);
    for (const Piece& above : pieces) {
        const auto up = height_along(above, middle, above.normal);
        if (!up) continue;
        for (const Piece& below : pieces) {
            if (vector::dot(above.normal, below.normal) > opposite) continue;
            const auto down = height_along(below, middle, above.normal);
            if (!down || std::abs(*up - *down) > request.most) continue;
            const Point3d between = vector::plus(middle, vector::times(above.normal, (*up + *down) / 2));
            if (contains(box, between) && request.surface.in_both(between)) return true;
        }
    }
    return false;
}

Cover find_cover(const CoverRequest& request) {
    Cover cover;
    CoverTest test(request, cover);
    if (request.pieces.empty()) {
        cover.found = test.run({});
        return cover;
    }
    if (const auto plank = single_plank(request.pieces)) cover.found = test.run({*plank});
    for (const double parallel : {0.9, 0.999}) {
        if (cover.found) break;
        if (auto planks = PlankSearch(request, parallel).run()) cover.found = test.run(std::move(*planks));
    }
    return cover;
}

}  // namespace octopair
