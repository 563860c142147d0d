// Boxes of two posed shapes: how far apart they are at least, in the world.
//
// Each shape has boxes in its own space, about an origin (mesh_tree.hpp). A pair of them is compared along the axes of both
// spaces, or of the world where a pose cannot be undone. Bounds hold for the places that vector::posed gives, whatever was
// rounded there and here: every comparison leaves room for it. What is not a number tells nothing apart.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "geometry/shape/mesh_tree.hpp"

namespace octopair {

/// A posed shape's boxes: their origin, and one that holds them all.
struct PosedBoxes {
    const Pose& pose;
    const Point3d& origin;
    const MeshNode& root;
};

class Separation {
public:
    Separation(const PosedBoxes& a, const PosedBoxes& b);

    /// At most the distance between what is in the one and in the other; 0 where they may meet.
    double least_distance(const MeshNode& a, const MeshNode& b) const {
        if (world_) return std::max(0.0, world_->greatest_gap(a, b));
        return std::max({0.0, of_a_.greatest_gap(a, b), of_b_.greatest_gap(b, a)});
    }

    /// True only if that is more than `reach`.
    bool apart(const MeshNode& a, const MeshNode& b, double reach) const {
        if (world_) return world_->greatest_gap(a, b) > reach;
        return of_a_.apart(a, b, reach) || of_b_.apart(b, a, reach);
    }

    /// Whether a is the one to be looked into: the larger of the two.
    bool first_is_larger(const MeshNode& a, const MeshNode& b) const {
        return std::max({a.half[0], a.half[1], a.half[2]}) * size_[0] >=
               std::max({b.half[0], b.half[1], b.half[2]}) * size_[1];
    }

private:
    using Matrix = std::array<std::array<double, 3>, 3>;

    /// An interval along an axis: what a linear map makes of a box.
    struct Interval {
        double centre, half;
    };
    static Interval along(const std::array<double, 3>& row, const MeshNode& node) {
        return {row[0] * double(node.centre[0]) + row[1] * double(node.centre[1]) + row[2] * double(node.centre[2]),
                std::abs(row[0]) * double(node.half[0]) + std::abs(row[1]) * double(node.half[1]) +
                    std::abs(row[2]) * double(node.half[2])};
    }

    /// Where the other's boxes are along some axes, how much room rounding needs there, and how many times as long a gap
    /// is in the world, at least.
    struct Axes {
        Matrix other = {};
        Point3d offset = {};
        Point3d slack = {};
        Point3d scale = {};

        double gap(int i, const Interval& own, const MeshNode& node) const {
            const Interval o = along(other[i], node);
            return (std::abs(offset[i] + o.centre - own.centre) - o.half - own.half - slack[i]) * scale[i];
        }
    };

    /// Those of the space of one shape.
    struct OwnAxes : Axes {
        double gap_along(int i, const MeshNode& own, const MeshNode& node) const {
            return gap(i, {double(own.centre[i]), double(own.half[i])}, node);
        }
        bool apart(const MeshNode& own, const MeshNode& node, double reach) const {
            for (int i = 0; i < 3; ++i) {
                if (gap_along(i, own, node) > reach) return true;
            }
            return false;
        }
        double greatest_gap(const MeshNode& own, const MeshNode& node) const {
            return std::max({gap_along(0, own, node), gap_along(1, own, node), gap_along(2, own, node)});
        }
    };

    /// Those of the world.
    struct WorldAxes : Axes {
        Matrix own = {};

        double greatest_gap(const MeshNode& a, const MeshNode& b) const {
            return std::max({gap(0, along(own[0], a), b), gap(1, along(own[1], a), b), gap(2, along(own[2], a), b)});
        }
    };

    /// Nothing where the pose of `own` cannot be undone well.
    static std::optional<OwnAxes> axes_of(const PosedBoxes& own, const PosedBoxes& other);
    static WorldAxes axes_of_world(const PosedBoxes& a, const PosedBoxes& b);

    OwnAxes of_a_, of_b_;
    std::optional<WorldAxes> world_;  // instead, where one of the poses cannot be undone well
    std::array<float, 2> size_;
};

}  // namespace octopair
