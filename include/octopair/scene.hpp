// Scene: objects that persist and move, and the pairs that begin and end from step to step.
//
// Result    After every step() pairs() equals a full detection with the same boxes, paddings, margin and traits, in ascending
//           order. `began` and `ended` are ascending, too. The result depends neither on the number of threads nor on how the
//           scene got its objects.
// Objects   An object has an index, which pairs and queries use, and a generation. An id never denotes two objects. The index
//           of a removed object is reused after the next step() at the earliest, so it denotes one object within a step.
// Errors    octopair::Error{bad_input}, with the position in the call, for an invalid box or an id that is not in the scene;
//           {resource_limit} if a step runs out of memory; calls other than step() then throw std::bad_alloc. A call that fails changes
//           nothing. A step() that fails or is cancelled leaves pairs() unchanged and may be repeated.
//           {engine_failed}, with the pair, if a search was wrong, which only an error in octopair causes: a step finds a
//           pair twice, a pair begins that existed, or a pair ends that did not exist. step(), pairs() or persisting() may
//           detect this. The next step() then searches all objects; pairs() may throw until then.
//           A scene that was moved from may only be destroyed or assigned to.
// Threads   One thread at a time, also for queries.
// Cost      A step's time depends on what moved; if most objects moved, it is that of a full detection. The first step in which
//           few objects moved builds an octree, which takes about five full detections, and longer where the memory is new. A query
//           right after a step builds the octree, too. docs/memory.md bounds the bytes per object and per pair. docs/results.md has measurements.
#pragma once

#include <compare>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <stop_token>
#include <string>
#include <vector>

#include "octopair/objects.hpp"
#include "octopair/octants.hpp"
#include "octopair/pair_list.hpp"
#include "octopair/queries.hpp"
#include "octopair/summary.hpp"

namespace [[gnu::visibility("default")]] octopair {

/// Identifies an object of a scene.
struct ObjectId {
    std::uint32_t index = ~std::uint32_t(0);
    std::uint32_t generation = 0;
    auto operator<=>(const ObjectId&) const = default;
};

/// Decides which objects can form a pair: each object's `mask` must have a bit of the other's `groups`, and at least one of the
/// objects must not be `fixed`.
struct Traits {
    std::uint32_t groups = 1;
    std::uint32_t mask = ~std::uint32_t(0);
    bool fixed = false;  ///< two fixed objects never form a pair; a fixed object may still be moved

    bool operator==(const Traits&) const = default;
};

/// Precision of the boxes of a scene.
enum class Precision : std::uint8_t { float32, float64 };

struct SceneOptions {
    unsigned threads = 0;  ///< at most max_threads; 0: one per core
    Precision precision = Precision::float32;
    double margin = 0;  ///< as in Options
    /// Path of a file that records all calls, for `octopair replay` (docs/formats.md); empty: none. An existing file is
    /// overwritten. Written before and after each step, never synced. A call that cannot be written throws Error{io_failed}.
    std::string recording = {};
    /// Called with the number of bytes before memory for pairs is allocated. To refuse the memory, the function throws; the call that
    /// needed the memory then throws this exception. Empty: no limit but the machine's memory.
    /// The function must not call the scene: octants() and calls that are not const throw Error{usage} there.
    /// Thread safety: called by any thread, one at a time.
    std::function<void(std::uint64_t bytes)> room_for_pairs = {};
    /// Length by which the scene enlarges the boxes that it searches, on each side. While an object stays within its enlarged box, a
    /// step does not search around it. pairs() does not depend on the slack. Slack saves time if most objects move a little in each step:
    /// a good slack is 20 to 100 times the length of such a move. Takes further memory per object and pair (docs/memory.md).
    /// 0: no slack.
    double slack = 0;
};

/// Result of a step. The spans are valid until the scene's next call that is not const.
struct StepResult {
    std::span<const Pair> began;   ///< pairs that began, by indices; a < b
    std::span<const Pair> ended;   ///< pairs that ended, including pairs of removed objects
    std::uint64_t persisting = 0;  ///< number of pairs that existed before and still exist
    bool full = false;             ///< true if all objects were searched, not only the changed ones
    double seconds = 0;            ///< wall-clock time

    /// Returns the number of all pairs after the step.
    std::uint64_t pairs() const { return persisting + began.size(); }
};

class Scene {
public:
    /// Makes an empty scene.
    /// Throws: Error{bad_input} for a margin that is not finite or below 0; Error{io_failed} if the recording cannot be
    /// created.
    explicit Scene(const SceneOptions& options = {});
    Scene(Scene&&) noexcept;
    Scene& operator=(Scene&&) noexcept;
    ~Scene();

    /// Adds objects and writes their ids to `ids`, which has one element per object. `traits` is empty (defaults), one element
    /// for all, or one element per object. Boxes must have the scene's precision. This and the calls below copy their arrays.
    void add(const Objects& objects, std::span<ObjectId> ids, std::span<const Traits> traits = {});
    /// Gives objects new boxes. If `ids` has an object twice, its last box counts.
    void move(std::span<const ObjectId> ids, const Boxes& boxes);
    /// Like move(), but in the next step an object's box is the union of its old and its new box. So a fast object misses no
    /// collision between frames. After that step its box is the new one.
    void sweep(std::span<const ObjectId> ids, const Boxes& boxes);
    void remove(std::span<const ObjectId> ids);
    /// Changes the traits of objects. `traits` has one element for all, or one element per object.
    void set_traits(std::span<const ObjectId> ids, std::span<const Traits> traits);

    /// Finds the pairs that began and ended since the last step.
    /// Throws: Error{cancelled} within 200 ms after a stop request, unless the step is done before.
    const StepResult& step(std::stop_token stop = {});

    /// Returns all pairs of the last step. Valid until the next step.
    const PairList& pairs();
    /// Returns the pairs of the last step that existed before it. Valid until the next step.
    const PairList& persisting();
    /// Returns the pairs of the boxes that the last step searched, in ascending order: with slack, enlarged boxes, whose pairs contain
    /// pairs(). They depend on how objects moved before. Valid until the next step.
    const PairList& enlarged_pairs();

    /// Compares pairs() with the pairs of a second algorithm, which shares no code with the octree (docs/proofs.md, "Certificates").
    /// Call it directly after step(), because the pairs are those of the last step.
    /// Throws: Error{engine_failed} that names a wrong or missing pair; Error{usage} if there was no step yet, or if an object was added,
    /// changed or removed since; Error{resource_limit} if the memory does not suffice; Error{cancelled} within 200 ms after a stop request.
    /// Complexity: as Options::verify, on the scene's threads. After a step with swept objects, also a copy of the boxes.
    Verification verify(std::stop_token stop = {});

    static constexpr std::uint32_t all_groups = ~std::uint32_t(0);

    /// Queries (queries.hpp). They use the current boxes; a swept object has its union box until the next step. They consider
    /// only objects whose traits have a bit of `groups`. `answers` gets the answers of each query.
    /// Throws: Error{bad_input} with the position of the first invalid query.
    /// Complexity: cheapest directly after a step().
    void overlaps(std::span<const Box3d> boxes, Answers<std::uint32_t>& answers, std::uint32_t groups = all_groups);
    void overlaps(std::span<const Sphere> spheres, Answers<std::uint32_t>& answers, std::uint32_t groups = all_groups);
    /// Finds the first hit of each ray, if there is one.
    void first_hits(std::span<const Ray> rays, Answers<RayHit>& answers, std::uint32_t groups = all_groups);
    /// Finds all hits of each ray.
    void all_hits(std::span<const Ray> rays, Answers<RayHit>& answers, std::uint32_t groups = all_groups);
    /// Finds the `count` objects nearest to each place, or all if there are fewer. A point is a box of extent 0.
    void nearest(std::span<const Box3d> places, std::size_t count, Answers<Neighbor>& answers,
                 std::uint32_t groups = all_groups);
    /// Like nearest() with `limits.count`, but leaves out objects that are farther than `limits.within`, which saves time.
    /// Throws: also Error{bad_input} if `limits.within` is below 0 or not a number.
    void nearest(std::span<const Box3d> places, const NearestLimits& limits, Answers<Neighbor>& answers,
                 std::uint32_t groups = all_groups);

    /// These make the same queries, and can be stopped. For many queries at once.
    /// Throws: also Error{cancelled} within 200 ms after a stop request, unless the answers are ready before. `answers` is then unspecified.
    void overlaps(std::span<const Box3d> boxes, Answers<std::uint32_t>& answers, std::uint32_t groups,
                  std::stop_token stop);
    void overlaps(std::span<const Sphere> spheres, Answers<std::uint32_t>& answers, std::uint32_t groups,
                  std::stop_token stop);
    void first_hits(std::span<const Ray> rays, Answers<RayHit>& answers, std::uint32_t groups, std::stop_token stop);
    void all_hits(std::span<const Ray> rays, Answers<RayHit>& answers, std::uint32_t groups, std::stop_token stop);
    void nearest(std::span<const Box3d> places, const NearestLimits& limits, Answers<Neighbor>& answers,
                 std::uint32_t groups, std::stop_token stop);

    /// Return the answers to a query with one box, sphere, ray or place.
    std::vector<std::uint32_t> overlaps(const Box3d& box, std::uint32_t groups = all_groups);
    std::vector<std::uint32_t> overlaps(const Sphere& sphere, std::uint32_t groups = all_groups);
    std::optional<RayHit> first_hit(const Ray& ray, std::uint32_t groups = all_groups);
    std::vector<RayHit> all_hits(const Ray& ray, std::uint32_t groups = all_groups);
    std::vector<Neighbor> nearest(const Box3d& place, std::size_t count, std::uint32_t groups = all_groups);

    std::uint64_t size() const;     ///< number of objects
    std::uint64_t indices() const;  ///< upper bound of the indices: every index is smaller
    bool contains(ObjectId id) const;
    /// Returns the id of the object at `index`. Throws: Error{bad_input} if there is none.
    ObjectId id(std::uint32_t index) const;
    /// Returns true if there is an object at `index`, which may be any number. Complexity: constant.
    bool exists(std::uint32_t index) const noexcept;

    /// Returns the current boxes by index, in the scene's precision: indices() boxes. The box at an index without an object has no
    /// meaning (exists()). A swept object has its union box until the next step, and then its new box. Boxes are those that the
    /// caller gave, also with slack. Valid until the scene's next call that is not const.
    /// Complexity: constant; nothing is copied.
    Boxes boxes() const;

    /// Lists the octants that a full detection of boxes() uses, with the paddings and the margin of the scene: the same as
    /// list_octants() of these boxes in the order of their indices, with indices in place of positions. Octants::home_octants() has
    /// indices() elements. Traits and slack change nothing. A step may use other octants: those of an earlier step while boxes move
    /// little, those of enlarged boxes with slack, or an octree that changes with the objects.
    /// Throws: Error{resource_limit} if the memory does not suffice; Error{cancelled} as list_octants() does.
    /// Complexity: that of list_octants(), on the scene's threads. If indices are not in use, also a copy of the boxes.
    Octants octants(std::stop_token stop = {}) const;

private:
    class [[gnu::visibility("hidden")]] State;
    std::unique_ptr<State> state_;
};

}  // namespace octopair
