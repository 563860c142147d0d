// Boxes of two posed shapes: how far apart they are at least, in the world.
//
// Each shape has boxes in its own space, about an origin (mesh_tree.hpp). A pair of them is compared along the axes of both
// spaces, or of the world where a pose cannot be undone. Bounds hold for the places that vector::posed gives, whatever was
// rounded there and here: every comparison leaves room for it. What is not a number tells nothing apart.
//
// Float32, four numbers at a time, of which the last is not used: mesh_walk_kernel.cpp does the same with vectors.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <limits>
#include <optional>

#include "narrow_phase/mesh/mesh_tree.hpp"

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
    float least_distance(const MeshNode& a, const MeshNode& b) const {
        if (world_) return std::max(0.0F, greatest(world_->gaps_between(a, b)));
        return std::max({0.0F, greatest(of_a_.gaps_to(a, b)), greatest(of_b_.gaps_to(b, a))});
    }

    /// True only if that is more than `reach`.
    bool apart(const MeshNode& a, const MeshNode& b, float reach) const {
        if (world_) return greatest(world_->gaps_between(a, b)) > reach;
        return greatest(of_a_.gaps_to(a, b)) > reach || greatest(of_b_.gaps_to(b, a)) > reach;
    }

    /// Whether a is the one to be looked into: the larger of the two.
    bool first_is_larger(const MeshNode& a, const MeshNode& b) const {
        return std::max({a.half[0], a.half[1], a.half[2]}) * size_[0] >=
               std::max({b.half[0], b.half[1], b.half[2]}) * size_[1];
    }

    struct alignas(16) Lanes {
        float at[4] = {};
    };
    static Lanes fetch(const float* from) {
        Lanes lanes;
        std::memcpy(lanes.at, from, sizeof lanes.at);
        return lanes;
    }

    /// A linear map, by columns.
    struct Map {
        Lanes column[3], magnitude[3];

        Lanes centre(const MeshNode& node) const { return combine(column, node.centre); }
        Lanes half(const MeshNode& node) const { return combine(magnitude, node.half); }

        static Lanes combine(const Lanes (&columns)[3], const float (&by)[3]) {
            Lanes sum;
            for (int i = 0; i < 4; ++i) {
                sum.at[i] = columns[0].at[i] * by[0] + columns[1].at[i] * by[1] + columns[2].at[i] * by[2];
            }
            return sum;
        }
    };

    /// Three axes: where the other's boxes are along them, how much room rounding needs there, and how many times as long a
    /// gap is in the world, at least.
    struct Axes {
        Map other;
        Lanes offset, slack, scale;

        /// The last one's slack is infinite, so it is no gap.
        Lanes gaps(const Lanes& own_centre, const Lanes& own_half, const MeshNode& node) const {
            const Lanes centre = other.centre(node), half = other.half(node);
            Lanes gap;
            for (int i = 0; i < 4; ++i) {
                gap.at[i] = (std::abs(offset.at[i] + centre.at[i] - own_centre.at[i]) -
                             (half.at[i] + own_half.at[i] + slack.at[i])) *
                            scale.at[i];
            }
            return gap;
        }
    };

    /// Not that which is no number.
    static float greatest(const Lanes& gaps) {
        float most = -std::numeric_limits<float>::infinity();
        for (int i = 0; i < 3; ++i) most = gaps.at[i] > most ? gaps.at[i] : most;
        return most;
    }

    /// Those of the space of one shape.
    struct OwnAxes : Axes {
        Lanes gaps_to(const MeshNode& own, const MeshNode& node) const {
            return gaps(fetch(own.centre), fetch(own.half), node);
        }
    };

    /// Those of the world.
    struct WorldAxes : Axes {
        Map own;

        Lanes gaps_between(const MeshNode& a, const MeshNode& b) const { return gaps(own.centre(a), own.half(a), b); }
    };

    const OwnAxes& of_a() const { return of_a_; }
    const OwnAxes& of_b() const { return of_b_; }
    /// Instead of these, where one of the poses cannot be undone well.
    const std::optional<WorldAxes>& of_world() const { return world_; }

private:
    using Matrix = std::array<std::array<double, 3>, 3>;
    static Map map_of(const Matrix& matrix);
    /// `room`: what float64 needs along each axis.
    static void round_to_lanes(const PosedBoxes& own, const PosedBoxes& other, double room, Axes& axes);
    /// Nothing where the pose of `own` cannot be undone well.
    static std::optional<OwnAxes> axes_of(const PosedBoxes& own, const PosedBoxes& other);
    static WorldAxes axes_of_world(const PosedBoxes& a, const PosedBoxes& b);

    OwnAxes of_a_, of_b_;
    std::optional<WorldAxes> world_;
    std::array<float, 2> size_;
};

}  // namespace octopair
