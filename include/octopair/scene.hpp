// Scene: objects that persist and move, and the pairs that begin and end from step to step.
//
// Result    after every step() pairs() is what a full detection of the same boxes, paddings, margin and traits finds,
//           ascending; `began` and `ended` are ascending as well. The same for any number of threads, and for any way in
//           which the scene came to be what it is.
// Objects   have an index, which pairs and queries name, and a generation: an id is of one object for ever. The index of a
//           removed object is given to another one after the next step() at the earliest, so within a step an index
//           means one object.
// Errors    octopair::Error{bad_input} for an id that is not (or no longer) of the scene, or a box that is not one, with its
//           position in the call; {resource_limit} where a step runs out of memory, std::bad_alloc elsewhere. A call that
//           fails changes nothing; a step() that fails or is cancelled leaves pairs() as they were, and may be repeated.
//           {engine_failed}, with the pair, if a search was wrong, which only an error in octopair causes: a step finds a
//           pair twice, or a pair begins that was there, or ends that was not. A step(), pairs() or persisting() may be
//           the call to see that. The step() after it searches all objects; pairs() may throw until then.
//           A scene that was moved from may only be destroyed or assigned to.
// Threads   one at a time, also for queries.
// Cost      a step's follows what moved; where most objects did, it is that of a full detection. About 120 bytes an object
//           and 16 a pair at the most; docs/results.md has what was measured.
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
#include "octopair/pair_list.hpp"
#include "octopair/queries.hpp"

namespace octopair {

/// An object of a scene.
struct ObjectId {
    std::uint32_t index = ~std::uint32_t(0);
    std::uint32_t generation = 0;
    auto operator<=>(const ObjectId&) const = default;
};

/// What an object pairs with: two objects do if each one's `mask` has a bit of the other's `groups`, and not both are
/// `fixed`.
struct Traits {
    std::uint32_t groups = 1;
    std::uint32_t mask = ~std::uint32_t(0);
    bool fixed = false;  ///< it may be moved nevertheless

    bool operator==(const Traits&) const = default;
};

/// Of the boxes of a scene.
enum class Precision : std::uint8_t { float32, float64 };

struct SceneOptions {
    unsigned threads = 0;  ///< 0: one per core
    Precision precision = Precision::float32;
    double margin = 0;  ///< as in Options
    /// Path of a file that all calls are written to, for `octopair replay` (docs/formats.md); empty: none. One that is there is
    /// emptied. Written before and after each step, never synced; a call that cannot be written throws Error{io_failed}.
    std::string recording = {};
    /// Asked before memory is taken for pairs, with its bytes, by any thread, one at a time. What it throws is thrown by the
    /// call that needed the memory, as if there were none. None: only the machine's memory is a limit.
    std::function<void(std::uint64_t bytes)> room_for_pairs = {};
};

/// What a step found. The spans are valid until the scene's next call that is not const.
struct StepResult {
    std::span<const Pair> began;   ///< a < b, by their indices
    std::span<const Pair> ended;   ///< also those of removed objects
    std::uint64_t persisting = 0;  ///< pairs that were there before and still are
    bool full = false;             ///< all objects were searched, not just those that changed
    double seconds = 0;            ///< wall clock

    std::uint64_t pairs() const { return persisting + began.size(); }
};

class Scene {
public:
    /// Throws Error{bad_input} for a margin that is not finite or below 0, Error{io_failed} if the recording cannot be made.
    explicit Scene(const SceneOptions& options = {});
    Scene(Scene&&) noexcept;
    Scene& operator=(Scene&&) noexcept;
    ~Scene();

    /// Adds objects, whose ids go to `ids` (as many as objects). `traits`: none for the defaults, one for all, or one for
    /// each. Boxes of the other precision than the scene's are an error; in all calls here arrays are copied.
    void add(const Objects& objects, std::span<ObjectId> ids, std::span<const Traits> traits = {});
    /// Gives objects new boxes; of an object that is named twice, the last counts.
    void move(std::span<const ObjectId> ids, const Boxes& boxes);
    /// The same, but for the next step an object's box is that of its whole way, from where it was: a fast one is not
    /// missed between frames. From the step after that on it is the given box.
    void sweep(std::span<const ObjectId> ids, const Boxes& boxes);
    void remove(std::span<const ObjectId> ids);
    /// One for all, or one for each.
    void set_traits(std::span<const ObjectId> ids, std::span<const Traits> traits);

    /// Finds what changed since the last step. Throws Error{cancelled} within 200 ms of a stop request, unless it is done
    /// before.
    const StepResult& step(std::stop_token stop = {});

    /// All pairs of the last step. Valid until the next step.
    const PairList& pairs();
    /// Those of them that were there before that step. Valid as long.
    const PairList& persisting();

    static constexpr std::uint32_t all_groups = ~std::uint32_t(0);

    /// Queries (queries.hpp): on the objects as they are now (until the next step, one that is swept is its whole way), of
    /// those that have a bit of `groups` in theirs. Cheapest right after a step(). Throw Error{bad_input} for a query that is none, with its position.
    void overlaps(std::span<const Box3d> boxes, Answers<std::uint32_t>& answers, std::uint32_t groups = all_groups);
    void overlaps(std::span<const Sphere> spheres, Answers<std::uint32_t>& answers, std::uint32_t groups = all_groups);
    /// One hit of each ray, or none.
    void first_hits(std::span<const Ray> rays, Answers<RayHit>& answers, std::uint32_t groups = all_groups);
    void all_hits(std::span<const Ray> rays, Answers<RayHit>& answers, std::uint32_t groups = all_groups);
    /// The `count` objects nearest to each place (or all, if there are no more); a point is a box of no extent.
    void nearest(std::span<const Box3d> places, std::size_t count, Answers<Neighbor>& answers,
                 std::uint32_t groups = all_groups);

    /// The same of one query.
    std::vector<std::uint32_t> overlaps(const Box3d& box, std::uint32_t groups = all_groups);
    std::vector<std::uint32_t> overlaps(const Sphere& sphere, std::uint32_t groups = all_groups);
    std::optional<RayHit> first_hit(const Ray& ray, std::uint32_t groups = all_groups);
    std::vector<RayHit> all_hits(const Ray& ray, std::uint32_t groups = all_groups);
    std::vector<Neighbor> nearest(const Box3d& place, std::size_t count, std::uint32_t groups = all_groups);

    std::uint64_t size() const;     ///< objects
    std::uint64_t indices() const;  ///< above every index
    bool contains(ObjectId id) const;
    /// Of the object at an index; Error{bad_input} if there is none.
    ObjectId id(std::uint32_t index) const;

private:
    class State;
    std::unique_ptr<State> state_;
};

}  // namespace octopair
