// StageCheck: checks the collisions that the exact filters have found among the pairs of a call.
//
// Result    Each pair of boxes, found anew by the second algorithm (row_search.hpp), must be a collision with a finding that no
//           certificate contradicts, or must rightly have been dropped (shape_pair.hpp). Each collision must be a pair of boxes.
// Memory    about 400 bytes per collision and 80 per contact, and 8 bytes per pair that exclusion rules leave out.
#pragma once

#include <cstdint>
#include <set>
#include <span>
#include <stop_token>
#include <string>
#include <vector>

#include "octopair/collision.hpp"
#include "octopair/objects.hpp"
#include "octopair/shapes.hpp"
#include "octopair/summary.hpp"
#include "verification/row_search.hpp"
#include "verification/shapes/shape_pair.hpp"

namespace octopair {

class StageCheck {
public:
    struct Setup {
        SearchedObjects boxes;  ///< boxes and margin of the call; borrowed
        const ShapedObjects& first;
        const ShapedObjects* second = nullptr;  ///< the other set of a join; null: pairs within `first`
        StageRules rules;
        unsigned threads = 0;  ///< 0: one per core
        std::stop_token stop = {};
    };
    struct Result {
        bool judged = true;                 ///< false: no decision was judged, because objects move
        std::set<std::string> not_checked;  ///< texts for users: what no certificate judged
    };
    explicit StageCheck(const Setup& setup) : setup_(setup) {}

    /// Takes collisions, in any order and in pieces of any length.
    void take(std::span<const Pair> pairs, std::span<const Finding> findings);
    /// Takes pairs of boxes that rules other than shapes have excluded.
    void exclude(std::span<const Pair> pairs) { excluded_.insert(excluded_.end(), pairs.begin(), pairs.end()); }
    /// Checks all pairs. Call once.
    /// Throws: Error{engine_failed} that names the first wrong pair; Error{cancelled}; std::bad_alloc.
    Result finish();

private:
    struct Collision {
        Pair pair;
        Finding finding;
    };
    bool has_motion() const;
    void check_collisions(const RowSearch& rows) const;
    const Finding* finding_of(Pair pair) const;
    std::string judge(Pair pair, std::set<std::string>& not_checked) const;

    Setup setup_;
    std::vector<Collision> collisions_;
    std::vector<Pair> excluded_;
};

}  // namespace octopair
