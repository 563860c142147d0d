// Baselines: well-known algorithms that find all overlapping pairs, written for readability.
//
// Result         Each pair once, a < b, in the order of the algorithm; `ascending` sorts the pairs.
// Requires       Valid boxes (objects.hpp).
// Thread safety  Functions may run concurrently. An ICollide must not be used by two threads at the same time.
// Use            Tests compare engines with `oracle_pairs`. Tests and benchmarks compare with the other baselines, too.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <stop_token>
#include <vector>

#include "octopair/objects.hpp"

namespace octopair::baselines {

/// Returns the pairs sorted by a, then b.
std::vector<Pair> ascending(std::vector<Pair> pairs);

/// Tests all n (n - 1) / 2 pairs. Returns the overlapping pairs in ascending order.
std::vector<Pair> naive_pairs(std::span<const Box3f> boxes);
std::vector<Pair> naive_pairs(std::span<const Box3d> boxes);

/// Tests all pairs by the rule of objects.hpp, literally, in float64. Returns the pairs in ascending order.
std::vector<Pair> oracle_pairs(const Objects& objects, double margin = 0);
/// Tests every object of `first` against every object of `second`.
std::vector<Pair> oracle_pairs_between(const Objects& first, const Objects& second, double margin = 0);

/// Sorts by the lower ends on one axis (0, 1, 2) and sweeps along it (the paper's section 2.3.1).
std::vector<Pair> sweep_and_prune(std::span<const Box3f> boxes, unsigned axis = 0);

/// I-COLLIDE's sweep and prune on three axes (section 2.3.1). Keeps sorted lists of interval ends from frame to frame
/// and sorts them again by insertion. Complexity: O(n + swaps) per frame after the first frame; memory O(n + pairs).
class ICollide {
public:
    ICollide();
    ~ICollide();
    /// Returns the pairs of the next frame. Object i is object i of the frame before. A different number of objects
    /// starts a new sequence.
    std::vector<Pair> next_frame(std::span<const Box3f> boxes);

private:
    struct State;
    std::unique_ptr<State> state_;
};

/// Sort algorithm of a slave: std::sort, where the paper uses qsort, or the radix sort of octopair. Both give equal
/// orders.
enum class PaperSort : std::uint8_t { standard, radix };

/// Settings of the paper's algorithm: `machines` times `slaves_per_machine` slaves, each a thread.
struct PaperSettings {
    unsigned level = 0;  ///< fixed depth of the octree, at most 21; 0: about one octant per object
    unsigned machines = 1;
    unsigned slaves_per_machine = 1;
    PaperSort sort = PaperSort::standard;
};

/// Wall-clock seconds of the components. If several slaves or machines work in parallel: seconds of the slowest.
struct PaperSeconds {
    double octal_codes = 0, sort = 0, merge_machine = 0, merge_master = 0, scan = 0;
};

struct PaperResult {
    std::vector<Pair> pairs;
    std::uint64_t entries = 0;     ///< octal codes of all objects
    std::uint64_t candidates = 0;  ///< pairs that share an octant, counted once per shared octant
    PaperSeconds seconds;
};

/// Finds all pairs by the paper's algorithm as published (section 3.3). An object larger than an octant has many codes,
/// which is an inherent cost of the algorithm.
PaperResult paper_pairs(std::span<const Box3f> boxes, const PaperSettings& settings = {});
/// Returns the fixed depth at which the paper's algorithm is fastest with the other `settings`. The search starts at
/// about one octant per object and goes up or down while the time falls, with one run per depth. After a stop request,
/// returns the fastest depth measured so far.
unsigned best_paper_level(std::span<const Box3f> boxes, const PaperSettings& settings = {},
                          const std::stop_token& stop = {});

/// Finds all pairs by a half traversal of a binary bounding volume hierarchy over the Morton order. Each leaf starts
/// from its own escape link. Requires: at most 2^31 - 1 boxes; `threads` >= 1.
std::vector<Pair> lbvh_pairs(std::span<const Box3f> boxes, unsigned threads = 1);

}  // namespace octopair::baselines
