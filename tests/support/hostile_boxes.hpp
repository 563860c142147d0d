// Boxes that another program overwrites during a call, such as those of a mapped file.
#pragma once

#include <atomic>
#include <cstdint>
#include <limits>
#include <span>

#include "octopair/objects.hpp"
#include "samples/random.hpp"

namespace octopair::test {

/// How boxes change: to other valid boxes, so that no check ends the call, or also to boxes that are not valid.
enum class Hostility : std::uint8_t { valid, any };

/// Overwrites boxes with hostile numbers. Other threads may read the boxes meanwhile.
template <typename Real>
class BoxOverwriter {
public:
    /// Borrows the boxes.
    BoxOverwriter(std::span<Box<Real>> boxes, Hostility hostility, std::uint64_t seed)
        : boxes_(boxes), hostility_(hostility), random_(seed, 7) {}

    void overwrite_one() {
        if (boxes_.empty()) return;
        Box<Real>& box = boxes_[random_.below(boxes_.size())];
        const std::uint64_t how = random_.below(hostility_ == Hostility::any ? 8 : 6);
        const Box<Real> other = boxes_[random_.below(boxes_.size())];
        for (int axis = 0; axis < 3; ++axis) {
            const Real place = Real(random_.uniform() * 100);
            switch (how) {
                case 0:
                    put(box, axis, other.min[axis], other.max[axis]);
                    break;
                case 1:
                    put(box, axis, place, place);
                    break;
                case 2:
                    put(box, axis, -most, most);
                    break;
                case 3:
                    put(box, axis, axis == int(place) % 3 ? -most : place, axis == int(place) % 3 ? most : place);
                    break;
                case 4:
                    put(box, axis, -least, least);
                    break;
                case 5:
                    put(box, axis, most, most);
                    break;
                case 6:
                    put(box, axis, place, place - 1);
                    break;
                default:
                    put(box, axis, odd(), odd());
            }
        }
    }

private:
    static constexpr Real most = std::numeric_limits<Real>::max(), least = std::numeric_limits<Real>::denorm_min();

    Real odd() {
        constexpr Real infinity = std::numeric_limits<Real>::infinity(), nan = std::numeric_limits<Real>::quiet_NaN();
        constexpr Real numbers[] = {nan, -nan, infinity, -infinity, 0, 1};
        return numbers[random_.below(6)];
    }
    static void put(Box<Real>& box, int axis, Real low, Real high) {
        std::atomic_ref(box.min[axis]).store(low, std::memory_order_relaxed);
        std::atomic_ref(box.max[axis]).store(high, std::memory_order_relaxed);
    }

    std::span<Box<Real>> boxes_;
    Hostility hostility_;
    samples::RandomStream random_;
};

}  // namespace octopair::test
