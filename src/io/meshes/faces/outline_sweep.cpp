#include "io/meshes/faces/outline_sweep.hpp"

#include <algorithm>
#include <cstdlib>
#include <iterator>
#include <map>
#include <span>
#include <tuple>
#include <utility>

#include "io/meshes/faces/plane_outline.hpp"

namespace octopair::io {

namespace {

using Gap = MonotonePieces::Gap;
using Side = MonotonePieces::Side;
using Triangles = std::vector<std::array<std::uint32_t, 3>>;

/// The part of a bundle that the sweep line crosses: from the bundle's last node up to the line, to its farthest end.
struct Stretch {
    std::uint32_t from, reach;
};

/// State of a bundle of edges on the sweep line.
struct Active {
    std::uint32_t bundle;
    int weight;
    int winding;  ///< winding number of the gap above
    Gap gap;      ///< gap above the bundle
};

/// Order of bundles and nodes on the sweep line, from below. A node on a bundle is equal to the bundle.
struct FromBelow {
    using is_transparent = void;
    const PlaneOutline* plane;

    bool operator()(const Stretch& a, std::uint32_t node) const { return plane->side(a.from, a.reach, node) > 0; }
    bool operator()(std::uint32_t node, const Stretch& a) const { return plane->side(a.from, a.reach, node) < 0; }
    bool operator()(const Stretch& a, const Stretch& b) const {
        if (a.from == b.from) return plane->side(a.from, a.reach, b.reach) > 0;
        return a.from < b.from ? (*this)(a, b.from) : (*this)(a.from, b);
    }
};

/// Edges along one straight line that together cover a stretch of this line without a gap.
struct Bundle {
    std::uint32_t first;   ///< leftmost node
    int weight = 0;        ///< sum of the weights of the edges that the sweep line crosses
    bool divided = false;  ///< true if a node lies on an edge, between its ends
};

/// A part of a bundle between neighbouring nodes, or a whole edge of the bundle.
struct BundlePart {
    std::uint32_t bundle, low, high;
    int weight;
};

/// An edge that begins at a node, or a bundle that continues to the right of a node.
struct Outgoing {
    static constexpr std::uint32_t no_bundle = ~std::uint32_t(0);
    std::uint32_t reach;
    std::uint32_t bundle = no_bundle;
    OutlineEdge* edge = nullptr;
};

class OutlineSweep {
public:
    explicit OutlineSweep(const PlaneOutline& outline)
        : outline_(outline),
          nodes_(outline),
          plane_(outline.with_places(nodes_.places())),
          pieces_(plane_, inside_),
          line_(FromBelow{&plane_}) {}
    OutlineSweep(const OutlineSweep&) = delete;
    OutlineSweep& operator=(const OutlineSweep&) = delete;

    bool run(Triangles& triangles) {
        for (std::uint32_t node = 0; node < nodes_.size(); ++node) {
            if (!visit(node)) return false;
        }
        if (winding_inside_ < 0) {
            for (auto& triangle : inside_) std::swap(triangle[1], triangle[2]);
        }
        fill_divided_bundles();
        for (const auto& [a, b, c] : inside_)
            triangles.push_back({nodes_.corner_of(a), nodes_.corner_of(b), nodes_.corner_of(c)});
        fill_heights(triangles);
        return true;
    }

private:
    using Line = std::map<Stretch, Active, FromBelow>;

    /// Moves the line over a node. Returns false if the outline crosses itself or folds.
    bool visit(std::uint32_t node) {
        const auto [begin, end] = line_.equal_range(node);
        Active* const below = begin == line_.begin() ? nullptr : &std::prev(begin)->second;
        const bool is_within_gap = begin == end;
        const Gap low = below == nullptr ? Gap{} : below->gap;
        const Gap high = is_within_gap ? low : std::prev(end)->second.gap;
        end_gaps(node, begin, end);
        if (!end_bundles(node, begin, end)) return false;
        const auto above = line_.erase(begin, end);
        if (!begin_bundles(node, above, below == nullptr ? 0 : below->winding)) return false;
        Active* const last = outgoing_.empty() ? nullptr : &std::prev(above)->second;
        join_gaps(node, {is_within_gap, low, high, below, last});
        return true;
    }

    /// Closes the gaps between the bundles that end at the node.
    void end_gaps(std::uint32_t node, Line::iterator begin, Line::iterator end) {
        if (begin == end) return;
        for (const auto last = std::prev(end); begin != last; ++begin) {
            if (begin->second.gap.is_inside()) pieces_.close(begin->second.gap, node);
        }
    }

    /// Ends the parts of bundles at a node, and lists the bundles that continue. If several continue, they cross: returns false.
    bool end_bundles(std::uint32_t node, Line::iterator begin, Line::iterator end) {
        outgoing_.clear();
        for (const std::uint32_t i : nodes_.ending_at(node)) {
            const OutlineEdge& edge = nodes_.edges()[i];
            bundles_[edge.bundle].weight -= edge.weight;
        }
        for (; begin != end; ++begin) {
            const auto& [stretch, active] = *begin;
            Bundle& bundle = bundles_[active.bundle];
            if (stretch.reach != node) {
                bundle.divided = true;
                outgoing_.push_back({stretch.reach, active.bundle});
            }
            if (bundle.divided) parts_.push_back({active.bundle, stretch.from, node, -active.weight});
        }
        return outgoing_.size() <= 1;
    }

    /// Puts the bundles that begin or continue at the node on the line, below `above`. `winding`: winding number below all these bundles.
    /// Returns false if the outline crosses itself or folds.
    bool begin_bundles(std::uint32_t node, Line::iterator above, int winding) {
        for (const std::uint32_t i : nodes_.starting_at(node)) {
            OutlineEdge& edge = nodes_.edges()[i];
            outgoing_.push_back({edge.high, Outgoing::no_bundle, &edge});
        }
        std::sort(outgoing_.begin(), outgoing_.end(),
                  [&](const Outgoing& a, const Outgoing& b) { return plane_.side(node, a.reach, b.reach) > 0; });
        auto first = above;
        for (std::size_t i = 0, next = 0; i < outgoing_.size(); i = next) {
            while (next < outgoing_.size() && plane_.side(node, outgoing_[i].reach, outgoing_[next].reach) == 0) ++next;
            if (i > 0 && winding != 0) std::prev(above)->second.gap = pieces_.open(node);
            const auto at = begin_bundle(node, above, std::span(outgoing_).subspan(i, next - i));
            winding += at->second.weight;
            at->second.winding = winding;
            if (!is_simple(winding)) return false;
            if (i == 0) first = at;
        }
        return !crosses_lower_neighbour(first) && (first == above || !crosses_lower_neighbour(above));
    }

    /// Puts one bundle on the line. `ways`: outgoing edges and the continuing bundle, all in one direction from the node.
    Line::iterator begin_bundle(std::uint32_t node, Line::iterator above, std::span<const Outgoing> ways) {
        std::uint32_t number = Outgoing::no_bundle, reach = node;
        for (const Outgoing& way : ways) {
            if (way.bundle != Outgoing::no_bundle) number = way.bundle;
            reach = std::max(reach, way.reach);
        }
        if (number == Outgoing::no_bundle) {
            number = std::uint32_t(bundles_.size());
            bundles_.push_back({node});
        }
        Bundle& bundle = bundles_[number];
        for (const Outgoing& way : ways) {
            if (way.edge == nullptr) continue;
            way.edge->bundle = number;
            bundle.weight += way.edge->weight;
        }
        return line_.emplace_hint(above, Stretch{node, reach}, Active{number, bundle.weight, 0, {}});
    }

    bool is_simple(int winding) {
        if (winding == 0) return true;
        if (winding_inside_ == 0) winding_inside_ = winding;
        return winding == winding_inside_ && std::abs(winding) == 1;
    }

    bool crosses_lower_neighbour(Line::iterator at) const {
        if (at == line_.end() || at == line_.begin()) return false;
        const Stretch &a = std::prev(at)->first, &b = at->first;
        return plane_.side(a.from, a.reach, b.from) * plane_.side(a.from, a.reach, b.reach) < 0 &&
               plane_.side(b.from, b.reach, a.from) * plane_.side(b.from, b.reach, a.reach) < 0;
    }

    /// The gaps that end or continue at a node, and the bundles below them.
    struct GapsAtNode {
        bool is_within_gap;
        Gap low, high;         // below and above the node, left of it; if the node is within a gap, `low` is this gap
        Active *below, *last;  // the bundle below the node, and the highest bundle that begins at it; or null
    };

    /// Adds a node to the gaps below and above it.
    void join_gaps(std::uint32_t node, const GapsAtNode& at) {
        Gap low, high;
        if (at.is_within_gap) {
            if (at.low.is_inside()) std::tie(low, high) = pieces_.split(at.low, node);
        } else {
            if (at.low.is_inside()) low = pieces_.extend(at.low, node, Side::upper);
            if (at.high.is_inside()) high = pieces_.extend(at.high, node, Side::lower);
        }
        if (at.last != nullptr) {
            at.last->gap = high;
        } else if (low.is_inside()) {
            low = MonotonePieces::merge(low, high);
        }
        if (at.below != nullptr) at.below->gap = low;
    }

    /// Adds triangles without area between a divided edge and its parts. Each triangle has the first node of the bundle as a corner.
    void fill_divided_bundles() {
        for (const OutlineEdge& edge : nodes_.edges()) {
            if (bundles_[edge.bundle].divided) parts_.push_back({edge.bundle, edge.low, edge.high, edge.weight});
        }
        const auto key = [](const BundlePart& part) { return std::tie(part.bundle, part.low, part.high); };
        std::sort(parts_.begin(), parts_.end(), [&](const BundlePart& a, const BundlePart& b) {
            plane_.check();
            return key(a) < key(b);
        });
        for (std::size_t i = 0, next = 0; i < parts_.size(); i = next) {
            const BundlePart& part = parts_[i];
            int weight = 0;
            for (; next < parts_.size() && key(parts_[next]) == key(part); ++next) weight += parts_[next].weight;
            const std::uint32_t first = bundles_[part.bundle].first;
            if (part.low == first) continue;
            for (int times = std::abs(weight); times > 0; --times) {
                plane_.check();
                inside_.push_back({first, weight > 0 ? part.low : part.high, weight > 0 ? part.high : part.low});
            }
        }
    }

    /// Adds triangles without area in the plane. They join each edge of the outline to the edge between the first corners of its nodes.
    void fill_heights(Triangles& triangles) const {
        const auto add = [&](std::uint32_t a, std::uint32_t b, std::uint32_t c) {
            const Point3d &at = outline_.place(a), &second = outline_.place(b), &third = outline_.place(c);
            if (at != second && second != third && third != at) triangles.push_back({a, b, c});
        };
        for (std::uint32_t from = 0; from < outline_.size(); ++from) {
            const std::uint32_t to = from + 1 < outline_.size() ? from + 1 : 0;
            const std::uint32_t first = nodes_.corner_of(nodes_.node_of(from));
            const std::uint32_t second = nodes_.corner_of(nodes_.node_of(to));
            if (first == from && second == to) continue;
            add(from, to, second);
            add(from, second, first);
        }
    }

    const PlaneOutline& outline_;
    OutlineNodes nodes_;
    const PlaneOutline plane_;  // outline through the nodes
    Triangles inside_;          // triangles between nodes
    MonotonePieces pieces_;
    Line line_;
    std::vector<Bundle> bundles_;
    std::vector<BundlePart> parts_;
    std::vector<Outgoing> outgoing_;  // edges and bundles to the right of the current node
    int winding_inside_ = 0;          // 0: not known yet
};

}  // namespace

bool cut_by_sweep(const PlaneOutline& outline, std::vector<std::array<std::uint32_t, 3>>& triangles) {
    return OutlineSweep(outline).run(triangles);
}

}  // namespace octopair::io
