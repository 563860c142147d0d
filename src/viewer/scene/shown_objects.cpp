#include "viewer/scene/shown_objects.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "octopair/octal_code.hpp"

namespace octopair::viewer {

Box3d box_of(const Boxes& boxes, std::size_t object) {
    return std::visit(
        [&](auto span) {
            Box3d box;
            for (int i = 0; i < 3; ++i) {
                box.min[i] = double(span[object].min[i]);
                box.max[i] = double(span[object].max[i]);
            }
            return box;
        },
        boxes);
}

Box3d joined(const Box3d& a, const Box3d& b) {
    Box3d out;
    for (int i = 0; i < 3; ++i) {
        out.min[i] = std::min(a.min[i], b.min[i]);
        out.max[i] = std::max(a.max[i], b.max[i]);
    }
    return out;
}

Point3d centre_of(const Box3d& box) {
    Point3d centre;
    for (std::size_t i = 0; i < 3; ++i) centre[i] = box.min[i] / 2 + box.max[i] / 2;
    return centre;
}

std::optional<Box3d> bounds_of(const FrameData& frame) {
    constexpr double infinity = std::numeric_limits<double>::infinity();
    const Box3d empty{{infinity, infinity, infinity}, {-infinity, -infinity, -infinity}};
    Box3d bounds = empty;
    const std::size_t objects = std::visit([](auto span) { return span.size(); }, frame.boxes);
    for (std::size_t i = 0; i < objects; ++i) {
        if (frame.has(i)) bounds = joined(bounds, box_of(frame, i));
    }
    if (!(bounds.min[0] <= bounds.max[0])) return std::nullopt;
    return bounds;
}

RelativeBox relative(const Box3d& box, const Point3d& origin) {
    RelativeBox out;
    for (std::size_t i = 0; i < 3; ++i) {
        out.ends[i] = float(box.min[i] - origin[i]);
        out.ends[i + 3] = float(box.max[i] - origin[i]);
    }
    return out;
}

RelativeBox no_box() {
    RelativeBox out;
    out.ends.fill(std::numeric_limits<float>::quiet_NaN());
    return out;
}

namespace {

/// Returns the octal key of a box's centre among cells that tile `bounds`.
std::uint64_t octal_key(const Box3d& box, const Box3d& bounds) {
    constexpr double cells = double(1 << OctalCode::max_level);
    const Point3d centre = centre_of(box);
    std::array<std::uint32_t, 3> cell;
    for (std::size_t i = 0; i < 3; ++i) {
        const double extent = bounds.max[i] / 2 - bounds.min[i] / 2;
        const double share = extent > 0 ? (centre[i] / 2 - bounds.min[i] / 2) / extent : 0;
        cell[i] = std::uint32_t(std::clamp(share * cells, 0.0, cells - 1));
    }
    return OctalCode::from_cell(cell, OctalCode::max_level).key();
}

double size_of(const Box3d& box) {
    return std::max({box.max[0] - box.min[0], box.max[1] - box.min[1], box.max[2] - box.min[2]});
}

}  // namespace

ShownObjects::ShownObjects(const FrameData& frame, std::uint64_t objects, std::size_t most) {
    const Box3d bounds = bounds_of(frame).value_or(no_bounds());
    std::vector<std::uint64_t> keys(std::size_t(objects), ~std::uint64_t(0));
    for (std::size_t i = 0; i < keys.size(); ++i) {
        if (frame.has(i)) keys[i] = octal_key(box_of(frame, i), bounds);
    }
    std::vector<std::uint32_t> order(keys.size());
    std::iota(order.begin(), order.end(), 0u);
    std::stable_sort(order.begin(), order.end(), [&](auto a, auto b) { return keys[a] < keys[b]; });
    rows_.assign(keys.size(), none);
    if (order.size() <= most) {
        objects_ = std::move(order);
    } else {
        const std::size_t large = most / 4;
        std::vector<std::uint32_t> by_size = order;
        const auto is_larger = [&](std::uint32_t a, std::uint32_t b) {
            const double x = frame.has(a) ? size_of(box_of(frame, a)) : -1,
                         y = frame.has(b) ? size_of(box_of(frame, b)) : -1;
            return x != y ? x > y : a < b;
        };
        std::nth_element(by_size.begin(), by_size.begin() + std::ptrdiff_t(large), by_size.end(), is_larger);
        for (std::size_t i = 0; i < large; ++i) rows_[by_size[i]] = 0;
        const std::size_t others = most - large, rest = order.size() - large;
        std::size_t seen = 0;
        for (const std::uint32_t object : order) {
            // Choose `others` of the `rest` objects that are not among the largest, at even distances in octal order.
            const bool chosen = rows_[object] == 0 || (seen + 1) * others / rest > seen * others / rest;
            seen += rows_[object] == 0 ? 0 : 1;
            if (chosen) objects_.push_back(object);
        }
    }
    rows_.assign(keys.size(), none);
    for (std::uint32_t row = 0; row < objects_.size(); ++row) rows_[objects_[row]] = row;
}

ShownObjects ShownObjects::first(std::size_t count) {
    ShownObjects shown;
    shown.objects_.resize(count);
    std::iota(shown.objects_.begin(), shown.objects_.end(), 0u);
    shown.rows_ = shown.objects_;
    return shown;
}

bool ShownObjects::in_order() const {
    if (objects_.size() != rows_.size()) return false;
    for (std::uint32_t row = 0; row < objects_.size(); ++row) {
        if (objects_[row] != row) return false;
    }
    return true;
}

}  // namespace octopair::viewer
