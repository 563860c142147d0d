// box_intersection_d and box_self_intersection_d: find intersecting boxes, with the signatures of CGAL's functions of these names.
//
//     #include <octopair/cgal/box_intersection_d.hpp>          // was: #include <CGAL/box_intersection_d.h>
//     namespace CGAL = octopair::cgal;                          // or write octopair::cgal for CGAL
//     CGAL::box_self_intersection_d(boxes.begin(), boxes.end(), callback);
//
// Result    callback(a, b) for each intersecting pair, once: in box_intersection_d a is of the first sequence. Boxes with equal ids do not
//           make a pair, except in box_self_intersection_all_pairs_d. The order of pairs depends on the boxes alone.
// Topology  CLOSED: boxes that touch intersect. HALF_OPEN: [min, max) on each axis.
// Boxes     of 3 dimensions, with coordinates in float, double or integers of at most 32 bits. Sequences are read once, and not reordered.
// Callback  Called on the calling thread, with the caller's floating-point environment. An exception of it ends the call.
// Errors    octopair::Error{bad_input}, with the position of the box, for a coordinate that is not a number.
// Speed     With Parallel_tag, one thread for each core finds pairs. `cutoff` is ignored.
//
// Differences from CGAL 5.5
//   HALF_OPEN leaves out boxes without extent on an axis. CGAL lets such a box intersect boxes that contain its place in their inside.
//   The setting COMPLETE takes both sequences for the same boxes and reports each pair once, with a and b both of the first sequence.
//   Infinite coordinates are taken for the largest finite ones.
//   A box with min > max makes no pair.
#pragma once

#include <cfenv>
#include <cmath>
#include <cstdint>
#include <functional>
#include <iterator>
#include <limits>
#include <memory>
#include <span>
#include <string>
#include <type_traits>
#include <vector>

#include "octopair/cgal/boxes.hpp"
#include "octopair/octopair.hpp"

namespace octopair::cgal {

/// Tags that choose the number of threads, as in box_self_intersection_d<Parallel_tag>(...).
struct Sequential_tag {};
struct Parallel_tag {};
using Parallel_if_available_tag = Parallel_tag;

namespace detail {

using Box_intersection_d::Setting;
using Box_intersection_d::Topology;

/// Type of coordinates in octopair for coordinates of type `Number`.
template <class Number>
using RealOf = std::conditional_t<std::is_same_v<Number, float>, float, double>;

template <class Traits>
constexpr void check_traits() {
    using Number = typename Traits::NT;
    static_assert(std::is_same_v<Number, float> || std::is_same_v<Number, double> ||
                      (std::is_integral_v<Number> && sizeof(Number) <= 4),
                  "octopair::cgal: coordinates must be float, double or integers of at most 32 bits");
    if constexpr (requires { std::integral_constant<int, Traits::dimension()>(); })
        static_assert(Traits::dimension() == 3, "octopair::cgal: boxes must have 3 dimensions");
}

/// The boxes of a sequence, and the places in the sequence that they come from. Boxes with min > max are left out.
template <class Traits, class Iterator>
struct Sequence {
    using Real = RealOf<typename Traits::NT>;

    Sequence(Iterator begin, Iterator end, Topology topology) {
        if (Traits::dimension() != 3) throw Error(ErrorCode::usage, "octopair::cgal: boxes must have 3 dimensions");
        std::size_t position = 0;
        for (Iterator at = begin; at != end; ++at, ++position) {
            Box<Real> box;
            bool is_empty = false;
            for (int axis = 0; axis < 3; ++axis) {
                const Real lower = finite(Real(Traits::min_coord(*at, axis)));
                Real upper = finite(Real(Traits::max_coord(*at, axis)));
                if (std::isnan(lower) || std::isnan(upper)) {
                    throw Error(ErrorCode::bad_input, "octopair::cgal: box " + std::to_string(position) +
                                                          " has a coordinate that is not a number");
                }
                if (topology == Topology::HALF_OPEN) upper = std::nextafter(upper, std::numeric_limits<Real>::lowest());
                box.min[axis] = lower;
                box.max[axis] = upper;
                is_empty |= lower > upper;
            }
            if (is_empty) continue;
            boxes.push_back(box);
            places.push_back(at);
        }
    }

    Objects objects() const { return {.boxes = std::span<const Box<Real>>(boxes)}; }

    std::vector<Box<Real>> boxes;
    std::vector<Iterator> places;

private:
    /// Returns the coordinate, or the largest finite one of its sign for infinity.
    static Real finite(Real coordinate) {
        constexpr Real largest = std::numeric_limits<Real>::max();
        return coordinate > largest ? largest : coordinate < -largest ? -largest : coordinate;
    }
};

template <class ConcurrencyTag>
std::unique_ptr<Engine> make_engine() {
    static_assert(std::is_same_v<ConcurrencyTag, Sequential_tag> || std::is_same_v<ConcurrencyTag, Parallel_tag>,
                  "octopair::cgal: the tag must be Sequential_tag or Parallel_tag");
    return make_local_engine(std::is_same_v<ConcurrencyTag, Parallel_tag> ? 0 : 1);
}

/// Sets the floating-point environment of this thread to another one, until destruction. octopair rounds to nearest while it searches.
class FloatingPointEnvironment {
public:
    explicit FloatingPointEnvironment(const std::fenv_t& other) {
        (void)std::fegetenv(&before_);
        (void)std::fesetenv(&other);
    }
    FloatingPointEnvironment(const FloatingPointEnvironment&) = delete;
    FloatingPointEnvironment& operator=(const FloatingPointEnvironment&) = delete;
    ~FloatingPointEnvironment() { (void)std::fesetenv(&before_); }

private:
    std::fenv_t before_{};
};

enum class EqualIds : std::uint8_t { make_no_pair, make_pairs };

/// Calls `callback` for the pairs of `input`, whose objects come from `first` and `second`.
template <class ConcurrencyTag, class Traits, EqualIds equal_ids, class First, class Second, class Callback>
void call_for_pairs(const Input& input, const First& first, const Second& second, Callback& callback) {
    std::fenv_t of_caller{};
    (void)std::fegetenv(&of_caller);
    const PairSink sink = [&](std::span<const Pair> pairs) {
        const FloatingPointEnvironment environment(of_caller);
        for (const auto [a, b] : pairs) {
            auto&& one = *first.places[a];
            auto&& other = *second.places[b];
            if (equal_ids == EqualIds::make_pairs || Traits::id(one) != Traits::id(other))
                std::invoke(callback, one, other);
        }
    };
    (void)make_engine<ConcurrencyTag>()->stream_pairs(input, sink, {.order = Order::octal});
}

template <class ConcurrencyTag, class Traits, EqualIds equal_ids = EqualIds::make_no_pair, class Iterator,
          class Callback>
void find_in_one(Iterator begin, Iterator end, Callback& callback, Topology topology) {
    check_traits<Traits>();
    const Sequence<Traits, Iterator> all(begin, end, topology);
    call_for_pairs<ConcurrencyTag, Traits, equal_ids>(all.objects(), all, all, callback);
}

template <class ConcurrencyTag, class Traits, class Iterator1, class Iterator2, class Callback>
void find_in_two(Iterator1 begin1, Iterator1 end1, Iterator2 begin2, Iterator2 end2, Callback& callback,
                 Topology topology) {
    check_traits<Traits>();
    const Sequence<Traits, Iterator1> first(begin1, end1, topology);
    const Sequence<Traits, Iterator2> second(begin2, end2, topology);
    call_for_pairs<ConcurrencyTag, Traits, EqualIds::make_no_pair>(Join{first.objects(), second.objects()}, first,
                                                                   second, callback);
}

template <class Iterator>
using TraitsOf = Box_intersection_d::Box_traits_d<typename std::iterator_traits<Iterator>::value_type>;

/// A traits class of the caller, in place of the argument `cutoff` or `topology`.
template <class T>
concept BoxTraits = requires { typename T::NT; };

}  // namespace detail

template <class ConcurrencyTag = Sequential_tag, class Iterator, class Callback>
void box_self_intersection_d(Iterator begin, Iterator end, Callback callback, std::ptrdiff_t /*cutoff*/ = 10,
                             Box_intersection_d::Topology topology = Box_intersection_d::CLOSED) {
    detail::find_in_one<ConcurrencyTag, detail::TraitsOf<Iterator>>(begin, end, callback, topology);
}

template <class ConcurrencyTag = Sequential_tag, class Iterator, class Callback, detail::BoxTraits Traits>
void box_self_intersection_d(Iterator begin, Iterator end, Callback callback, Traits, std::ptrdiff_t /*cutoff*/ = 10,
                             Box_intersection_d::Topology topology = Box_intersection_d::CLOSED) {
    detail::find_in_one<ConcurrencyTag, Traits>(begin, end, callback, topology);
}

template <class ConcurrencyTag = Sequential_tag, class Iterator1, class Iterator2, class Callback,
          detail::BoxTraits Traits>
void box_intersection_d(Iterator1 begin1, Iterator1 end1, Iterator2 begin2, Iterator2 end2, Callback callback, Traits,
                        std::ptrdiff_t /*cutoff*/ = 10,
                        Box_intersection_d::Topology topology = Box_intersection_d::CLOSED,
                        Box_intersection_d::Setting setting = Box_intersection_d::BIPARTITE) {
    if (setting == Box_intersection_d::COMPLETE)
        detail::find_in_one<ConcurrencyTag, Traits>(begin1, end1, callback, topology);
    else
        detail::find_in_two<ConcurrencyTag, Traits>(begin1, end1, begin2, end2, callback, topology);
}

template <class ConcurrencyTag = Sequential_tag, class Iterator1, class Iterator2, class Callback>
void box_intersection_d(Iterator1 begin1, Iterator1 end1, Iterator2 begin2, Iterator2 end2, Callback callback,
                        std::ptrdiff_t cutoff = 10, Box_intersection_d::Topology topology = Box_intersection_d::CLOSED,
                        Box_intersection_d::Setting setting = Box_intersection_d::BIPARTITE) {
    box_intersection_d<ConcurrencyTag>(begin1, end1, begin2, end2, callback, detail::TraitsOf<Iterator1>(), cutoff,
                                       topology, setting);
}

// CGAL compares all pairs in these functions. Here they are as fast as those above.

template <class Iterator, class Callback>
void box_self_intersection_all_pairs_d(Iterator begin, Iterator end, Callback callback,
                                       Box_intersection_d::Topology topology = Box_intersection_d::CLOSED) {
    detail::find_in_one<Sequential_tag, detail::TraitsOf<Iterator>, detail::EqualIds::make_pairs>(begin, end, callback,
                                                                                                  topology);
}

template <class Iterator, class Callback, detail::BoxTraits Traits>
void box_self_intersection_all_pairs_d(Iterator begin, Iterator end, Callback callback, Traits,
                                       Box_intersection_d::Topology topology = Box_intersection_d::CLOSED) {
    detail::find_in_one<Sequential_tag, Traits, detail::EqualIds::make_pairs>(begin, end, callback, topology);
}

template <class Iterator1, class Iterator2, class Callback>
void box_intersection_all_pairs_d(Iterator1 begin1, Iterator1 end1, Iterator2 begin2, Iterator2 end2, Callback callback,
                                  Box_intersection_d::Topology topology = Box_intersection_d::CLOSED,
                                  Box_intersection_d::Setting setting = Box_intersection_d::BIPARTITE) {
    box_intersection_d(begin1, end1, begin2, end2, callback, 10, topology, setting);
}

template <class Iterator1, class Iterator2, class Callback, detail::BoxTraits Traits>
void box_intersection_all_pairs_d(Iterator1 begin1, Iterator1 end1, Iterator2 begin2, Iterator2 end2, Callback callback,
                                  Traits traits, Box_intersection_d::Topology topology = Box_intersection_d::CLOSED,
                                  Box_intersection_d::Setting setting = Box_intersection_d::BIPARTITE) {
    box_intersection_d(begin1, end1, begin2, end2, callback, traits, 10, topology, setting);
}

}  // namespace octopair::cgal
