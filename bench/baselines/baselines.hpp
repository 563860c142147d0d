// Baselines: the known ways to find all overlapping pairs, written to be read.
//
// Result    each pair once, a < b, in the algorithm's own order; `ascending` sorts it. Boxes are valid (objects.hpp).
// Threads   every call stands alone; an ICollide belongs to one thread at a time.
// Use       `oracle_pairs` judges the engines in tests; the others are rivals in tests and benchmarks.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <stop_token>
#include <vector>

#include "octopair/objects.hpp"

namespace octopair::baselines {

/// The same pairs sorted by a, then b.
std::vector<Pair> ascending(std::vector<Pair> pairs);

/// All n (n - 1) / 2 pairs tested, in ascending order.
std::vector<Pair> naive_pairs(std::span<const Box3f> boxes);
std::vector<Pair> naive_pairs(std::span<const Box3d> boxes);

/// All pairs tested by the rule of objects.hpp, literally, in float64; in ascending order.
std::vector<Pair> oracle_pairs(const Objects& objects, double margin = 0);
/// Every object of `first` against every one of `second`.
std::vector<Pair> oracle_pairs_between(const Objects& first, const Objects& second, double margin = 0);

/// Sorts by the lower ends on one axis (0, 1, 2) and sweeps along it (the paper's section 2.3.1).
std::vector<Pair> sweep_and_prune(std::span<const Box3f> boxes, unsigned axis = 0);

/// I-COLLIDE's sweep and prune on three axes: sorted lists of interval ends are kept from frame to frame and sorted
/// again by insertion (section 2.3.1). Time after the first frame: O(n + swaps); memory O(n + pairs).
class ICollide {
public:
    ICollide();
    ~ICollide();
    /// The pairs of the next frame. Object i is the one that was i before; another number of objects starts afresh.
    std::vector<Pair> next_frame(std::span<const Box3f> boxes);

private:
    struct State;
    std::unique_ptr<State> state_;
};

/// What a slave sorts its entries by: the library's sort, as the paper does by qsort, or the radix sort of octopair. The
/// order is the same.
enum class PaperSort : std::uint8_t { standard, radix };

/// How the paper's algorithm is run: `machines` times `slaves_per_machine` slaves, each a thread.
struct PaperSettings {
    unsigned level = 0;  ///< the fixed depth of the octree, at most 21; 0: about one octant per object
    unsigned machines = 1;
    unsigned slaves_per_machine = 1;
    PaperSort sort = PaperSort::standard;
};

/// Wall-clock seconds of its components: the slowest slave or machine where several work side by side.
struct PaperSeconds {
    double octal_codes = 0, sort = 0, merge_machine = 0, merge_master = 0, scan = 0;
};

struct PaperResult {
    std::vector<Pair> pairs;
    std::uint64_t entries = 0;     ///< octal codes of all objects
    std::uint64_t candidates = 0;  ///< pairs that share an octant, counted once for each that they share
    PaperSeconds seconds;
};

/// The paper's algorithm as published (section 3.3). Objects larger than an octant have many codes there: that is its
/// nature, and its cost.
PaperResult paper_pairs(std::span<const Box3f> boxes, const PaperSettings& settings = {});
/// The fixed depth at which that is fastest, with `settings` else: from about one octant an object up or down while it gets
/// faster, one run with each. After a stop request, of those tried.
unsigned best_paper_level(std::span<const Box3f> boxes, const PaperSettings& settings = {},
                          const std::stop_token& stop = {});

/// A binary bounding volume hierarchy over the Morton order, half traversed: each leaf starts from its own escape link.
/// At most 2^31 - 1 boxes; `threads` >= 1.
std::vector<Pair> lbvh_pairs(std::span<const Box3f> boxes, unsigned threads = 1);

}  // namespace octopair::baselines
