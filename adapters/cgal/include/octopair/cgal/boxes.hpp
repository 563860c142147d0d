// Boxes with the interface of CGAL's, for box_intersection_d.hpp: Box_d and Box_with_handle_d, their policies for ids, and their traits.
// Facts about the interface are from CGAL's manual ("Intersecting Sequences of dD Iso-oriented Boxes"); no code of CGAL is used.
//
// Differences from CGAL 5.5
//   Boxes of double are constructed from any type with xmin(), ymin(), zmin(), xmax(), ymax() and zmax(), in place of CGAL's Bbox_3. There
//   is no function bbox() and no Box_with_info_d.
//   Corners are passed as pointers to constant numbers, so arrays of constants work, too.
#pragma once

#include <algorithm>
#include <array>
#include <atomic>
#include <cstddef>
#include <limits>
#include <type_traits>
#include <utility>

namespace octopair::cgal::Box_intersection_d {

enum Setting { COMPLETE, BIPARTITE };
enum Topology { HALF_OPEN, CLOSED };

// Policies: where the id of a box comes from.
struct ID_NONE {};              ///< the box has no id; base class of the others
struct ID_EXPLICIT {};          ///< a number that the box gets when it is made; copies have the same number
struct ID_FROM_BOX_ADDRESS {};  ///< the address of the box
struct ID_FROM_HANDLE {};       ///< the address of what the handle refers to

template <class Number, int dimensions, class IdPolicy = ID_EXPLICIT>
class Box_d;

/// Corners of a box. `dimensions` > 0.
template <class Number, int dimensions>
class Box_d<Number, dimensions, ID_NONE> {
public:
    using NT = Number;
    using ID = std::size_t;

    /// The corners are not initialised.
    Box_d() = default;
    Box_d(bool complete) { init(complete); }  // NOLINT(google-explicit-constructor): CGAL's is implicit
    /// `lower`, `upper`: `dimensions` numbers each.
    Box_d(const Number* lower, const Number* upper) {
        std::copy_n(lower, dimensions, lower_.begin());
        std::copy_n(upper, dimensions, upper_.begin());
    }
    template <class Bbox>
        requires(dimensions == 3 && std::is_same_v<Number, double>) && requires(const Bbox& box) { box.zmax(); }
    Box_d(const Bbox& box)  // NOLINT(google-explicit-constructor): CGAL's is implicit
        : lower_{Number(box.xmin()), Number(box.ymin()), Number(box.zmin())},
          upper_{Number(box.xmax()), Number(box.ymax()), Number(box.zmax())} {}

    /// Makes the box empty, or `complete`: the box of all points.
    void init(bool complete = false) {
        lower_.fill(complete ? std::numeric_limits<Number>::lowest() : std::numeric_limits<Number>::max());
        upper_.fill(complete ? std::numeric_limits<Number>::max() : std::numeric_limits<Number>::lowest());
    }
    /// Extends the box to contain a point.
    void extend(const Number* point) {
        for (std::size_t axis = 0; axis < std::size_t(dimensions); ++axis) extend(axis, point[axis], point[axis]);
    }
    /// Extends the box to contain an interval for each axis.
    void extend(const std::pair<Number, Number>* intervals) {
        for (std::size_t axis = 0; axis < std::size_t(dimensions); ++axis)
            extend(axis, intervals[axis].first, intervals[axis].second);
    }

    static constexpr int dimension() { return dimensions; }
    Number min_coord(int axis) const { return lower_[std::size_t(axis)]; }
    Number max_coord(int axis) const { return upper_[std::size_t(axis)]; }

private:
    void extend(std::size_t axis, Number lower, Number upper) {
        lower_[axis] = std::min(lower_[axis], lower);
        upper_[axis] = std::max(upper_[axis], upper);
    }

    std::array<Number, std::size_t(dimensions)> lower_, upper_;
};

template <class Number, int dimensions>
class Box_d<Number, dimensions, ID_EXPLICIT> : public Box_d<Number, dimensions, ID_NONE> {
public:
    using Box_d<Number, dimensions, ID_NONE>::Box_d;
    Box_d() = default;

    std::size_t id() const { return id_; }

private:
    static std::size_t next() {
        static std::atomic<std::size_t> made = 0;
        return made++;
    }

    std::size_t id_ = next();
};

template <class Number, int dimensions>
class Box_d<Number, dimensions, ID_FROM_BOX_ADDRESS> : public Box_d<Number, dimensions, ID_NONE> {
public:
    using Box_d<Number, dimensions, ID_NONE>::Box_d;
    Box_d() = default;

    std::size_t id() const { return reinterpret_cast<std::size_t>(this); }
};

namespace detail {

/// Base class of a box with a handle. A handle gives the id in place of a policy of Box_d.
template <class Number, int dimensions, class IdPolicy>
using HandleBase =
    Box_d<Number, dimensions, std::conditional_t<std::is_same_v<IdPolicy, ID_FROM_HANDLE>, ID_NONE, IdPolicy>>;

}  // namespace detail

/// A box that refers to an object, for example by an iterator or a pointer.
template <class Number, int dimensions, class Referring, class IdPolicy = ID_FROM_HANDLE>
class Box_with_handle_d : public detail::HandleBase<Number, dimensions, IdPolicy> {
    using Base = detail::HandleBase<Number, dimensions, IdPolicy>;

public:
    using Handle = Referring;

    Box_with_handle_d() = default;
    Box_with_handle_d(Handle handle) : handle_(handle) {}  // NOLINT(google-explicit-constructor): as above
    Box_with_handle_d(bool complete, Handle handle) : Base(complete), handle_(handle) {}
    Box_with_handle_d(const Number* lower, const Number* upper, Handle handle) : Base(lower, upper), handle_(handle) {}
    template <class Bbox>
        requires(dimensions == 3 && std::is_same_v<Number, double>) && requires(const Bbox& box) { box.zmax(); }
    Box_with_handle_d(const Bbox& box, Handle handle) : Base(box), handle_(handle) {}

    Handle handle() const { return handle_; }
    std::size_t id() const {
        if constexpr (std::is_same_v<IdPolicy, ID_FROM_HANDLE>)
            return reinterpret_cast<std::size_t>(&*handle_);
        else
            return Base::id();
    }

private:
    Handle handle_;
};

/// Access to the boxes of a sequence of boxes.
template <class Box>
struct Box_traits_d {
    using Box_parameter = const Box&;
    using NT = typename Box::NT;
    using ID = typename Box::ID;

    static NT min_coord(Box_parameter box, int axis) { return box.min_coord(axis); }
    static NT max_coord(Box_parameter box, int axis) { return box.max_coord(axis); }
    static ID id(Box_parameter box) { return box.id(); }
    static constexpr int dimension() { return Box::dimension(); }
};

/// Access to the boxes of a sequence of pointers.
template <class Box>
struct Box_traits_d<Box*> {
    using Box_parameter = const Box*;
    using NT = typename Box::NT;
    using ID = typename Box::ID;

    static NT min_coord(Box_parameter box, int axis) { return box->min_coord(axis); }
    static NT max_coord(Box_parameter box, int axis) { return box->max_coord(axis); }
    static ID id(Box_parameter box) { return box->id(); }
    static constexpr int dimension() { return Box::dimension(); }
};

}  // namespace octopair::cgal::Box_intersection_d
