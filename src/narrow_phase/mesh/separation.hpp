// Separation: lower bounds on the world distance of boxes of two posed shapes.
//
// Boxes     Each shape has boxes in its own coordinates, relative to an origin (mesh_tree.hpp).
// Axes      A pair of boxes is compared along the axes of both shapes. If a pose cannot be inverted well, along the world axes.
// Rounding  Bounds hold for the places that vector::posed computes. Every comparison has slack for the rounding there and here.
// NaN       A comparison with NaN never separates two boxes.
// Lanes     All numbers are float32, four at a time; the last is not used. mesh_walk_kernel.cpp is the SIMD version.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <limits>
#include <optional>

#include "narrow_phase/mesh/mesh_tree.hpp"

namespace octopair {

/// The boxes of a posed shape.
struct PosedBoxes {
    const Pose& pose;
    const Point3d& origin;  ///< origin of all boxes
    const MeshNode& root;   ///< contains all other boxes
};

class Separation {
public:
    Separation(const PosedBoxes& a, const PosedBoxes& b);

    /// Returns a lower bound on the distance of the contents of two boxes; 0 if they may meet.
    float min_distance(const MeshNode& a, const MeshNode& b) const {
        if (world_) return std::max(0.0F, greatest(world_->gaps_between(a, b)));
        return std::max({0.0F, greatest(of_a_.gaps_to(a, b)), greatest(of_b_.gaps_to(b, a))});
    }

    /// Returns true only if the distance of the contents is larger than `reach`.
    bool apart(const MeshNode& a, const MeshNode& b, float reach) const {
        if (world_) return greatest(world_->gaps_between(a, b)) > reach;
        return greatest(of_a_.gaps_to(a, b)) > reach || greatest(of_b_.gaps_to(b, a)) > reach;
    }

    /// Returns true if a is the larger of the two boxes in the world, or as large as b.
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

    /// Three axes along which boxes are compared.
    struct Axes {
        Map other;     ///< maps boxes of the other shape to these axes
        Lanes offset;  ///< from the own origin to the other origin
        Lanes slack;   ///< bound on the rounding error; infinite in the last lane
        Lanes scale;   ///< lower bound on the world length of a gap of length 1

        /// Returns the gaps along the axes, below 0 for an overlap. The last lane is -infinity: its slack is infinite.
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

    /// Returns the largest of the three gaps; ignores NaN.
    static float greatest(const Lanes& gaps) {
        float most = -std::numeric_limits<float>::infinity();
        for (int i = 0; i < 3; ++i) most = gaps.at[i] > most ? gaps.at[i] : most;
        return most;
    }

    /// Axes of one shape's own coordinates.
    struct OwnAxes : Axes {
        Lanes gaps_to(const MeshNode& own, const MeshNode& node) const {
            return gaps(fetch(own.centre), fetch(own.half), node);
        }
    };

    /// Axes of the world.
    struct WorldAxes : Axes {
        Map own;

        Lanes gaps_between(const MeshNode& a, const MeshNode& b) const { return gaps(own.centre(a), own.half(a), b); }
    };

    const OwnAxes& of_a() const { return of_a_; }
    const OwnAxes& of_b() const { return of_b_; }
    /// Replaces of_a() and of_b() if one of the poses cannot be inverted well.
    const std::optional<WorldAxes>& of_world() const { return world_; }

private:
    using Matrix = std::array<std::array<double, 3>, 3>;
    static Map map_of(const Matrix& matrix);
    /// Sets slack and the last lane of `axes`. `room` is the bound on the float64 rounding error along each axis.
    static void round_to_lanes(const PosedBoxes& own, const PosedBoxes& other, double room, Axes& axes);
    /// Returns nothing if the pose of `own` cannot be inverted well.
    static std::optional<OwnAxes> axes_of(const PosedBoxes& own, const PosedBoxes& other);
    static WorldAxes axes_of_world(const PosedBoxes& a, const PosedBoxes& b);

    OwnAxes of_a_, of_b_;
    std::optional<WorldAxes> world_;
    std::array<float, 2> size_;
};

}  // namespace octopair
