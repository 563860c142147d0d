// Octants: the octants of the octree that a search uses, with the objects that each octant stores.
//
// Octants   In pre-order: the root first, and an octant directly before all octants below it. An octant has eight children, in
//           the order of digits, or none. A search may divide a crowded leaf further while it scans the leaf; these octants
//           are not listed.
// Entries   An octant stores an entry for each of its objects. An object has one to eight entries. Their octants tile the cells that
//           its box touches. They are leaves or, for a large box, octants of the level at which the box touches at most eight. An
//           entry in an octant that is no leaf stands for all octants below it.
// Home      Each object has one home: of the octants with its entries, the octant in which its box begins, which holds the box's
//           low corner. So the home of a large box may have octants below it.
// Bounds    In the unit and the coordinates of the boxes. Bounds of neighbours meet exactly, and those of children tile their parent.
//           A box is widened by margin / 2 and its padding, and then mapped to cells in float32. If a box ends very close to a face of
//           an octant, rounding decides on which side of the face the box ends. Very close means within a cell, which is 2^-21 of the
//           root's side, or within 2^-20 of the box's coordinates.
// Border    The octree covers the bulk of the objects. Coordinates outside of space() count as the nearest cell within. So an
//           octant at a face of space() also stores boxes beyond this face. Octants may reach beyond the upper faces of space(). An
//           octant that lies beyond them has no entries. Bounds never exceed the range of float32. So in scenes as large as this
//           range, octants at the upper border may have bounds of extent 0.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <stop_token>
#include <vector>

#include "octopair/objects.hpp"
#include "octopair/octal_code.hpp"

namespace [[gnu::visibility("default")]] octopair {

class Octants;

namespace detail {  // not for users
struct OctantLists;
Octants make_octants(std::shared_ptr<const OctantLists> lists) noexcept;
}  // namespace detail

/// An octant of a search.
struct OctantSummary {
    OctalCode code;
    Box3d bounds = {};          ///< always finite, also at the border
    bool leaf = true;           ///< true if the octant has no children
    std::uint64_t entries = 0;  ///< number of entries in this octant, without those in octants below it
    std::uint64_t homes = 0;    ///< number of these entries whose objects have their home here
};

/// The octants of a search. A copy shares its data.
/// Thread safety: several threads may read one object.
class Octants {
public:
    /// Makes a list without octants.
    Octants() noexcept;
    Octants(const Octants&) noexcept;
    Octants(Octants&&) noexcept;
    Octants& operator=(const Octants&) noexcept;
    Octants& operator=(Octants&&) noexcept;
    ~Octants();

    static constexpr std::uint32_t no_octant = ~std::uint32_t(0);
    static constexpr std::uint8_t no_level = 255;

    /// Returns all octants in pre-order. There is at least the root, unless the list was made without octants. Valid as long as a
    /// copy of this list exists. Complexity: constant.
    std::span<const OctantSummary> all() const noexcept;
    /// Returns the objects with an entry in all()[octant]: first the objects that have their home there, then the other objects. Each
    /// part ascends by index. Valid as long as a copy of this list exists.
    /// Requires: octant < all().size(). Complexity: constant.
    std::span<const std::uint32_t> objects(std::size_t octant) const noexcept;
    /// Returns for each object the position of its home in all(), or `no_octant` for an index of a scene without an object. Valid as
    /// long as a copy of this list exists. Complexity: constant.
    std::span<const std::uint32_t> home_octants() const noexcept;
    /// Returns for each object the level of its home, 0 to OctalCode::max_level, or `no_level` for an index of a scene without an
    /// object. Complexity: linear in the number of objects.
    std::vector<std::uint8_t> levels() const;
    /// Returns the part of the root in which objects are looked up. Its low corner is that of the root.
    Box3d space() const noexcept;

private:
    friend Octants detail::make_octants(std::shared_ptr<const detail::OctantLists> lists) noexcept;
    std::shared_ptr<const detail::OctantLists> lists_;  // null for a list without octants
};

struct OctantOptions {
    double margin = 0;     ///< as in Options
    unsigned threads = 0;  ///< 0: one per core
};

/// Lists the octants that a search of these objects uses: Engine::find_pairs() of the local engine builds the same octree. The result
/// depends neither on the number of threads nor on the instruction set. The sum of `entries` is Summary::entries of this search.
/// Throws: Error{bad_input} with the object and the value for an invalid box, padding or margin; Error{resource_limit} if the memory
/// does not suffice, or for more than 2^32 - 1 objects; Error{cancelled} within 200 ms after a stop request, unless the list is
/// complete before.
/// Complexity: time of the search without its scan, and O(entries), divided among the threads. The result has 4 bytes
/// per entry, 4 per object and 96 per octant. Until the function returns, it also needs the memory that a search takes for the octree.
Octants list_octants(const Objects& objects, const OctantOptions& options = {}, std::stop_token stop = {});

}  // namespace octopair
