// LargeHistory: a scene of many objects that are added, moved and removed. Compares each step with the second algorithm
// (src/verification).
//
// Objects    Objects of a random call of a family (support/families.hpp). Both sets of a join form one scene.
// Failures   In half of the histories calls fail before they succeed (scene/failing_scene.hpp).
// Scenes     With test hooks, two scenes get identical calls. The first searches around changes where possible, the
//            second searches all objects at each step. Without test hooks, a single scene chooses by measured times.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "base/tuning.hpp"
#include "exactness/case_check.hpp"
#include "octopair/octopair.hpp"
#include "samples/random.hpp"
#include "scene/failing_scene.hpp"
#include "support/cases.hpp"

namespace octopair::test {

class LargeHistory {
public:
    static constexpr int steps = 6;
    static constexpr std::uint64_t max_pairs_per_object = 60;

    /// A pure function of its arguments. `objects`: approximate number of objects.
    LargeHistory(const std::string& family, std::uint64_t objects, std::uint64_t seed);

    /// Returns whether there are so many pairs that the second algorithm would take too long.
    bool has_too_many_pairs() const { return too_many_; }
    /// Makes all steps, or stops early if there are too many pairs. Returns the first finding. Requires: not too many
    /// pairs at the start. Call at most once.
    std::optional<Finding> run();

    std::string describe() const;
    std::uint64_t full_steps() const { return full_steps_; }
    std::uint64_t partial_steps() const { return partial_steps_; }
    /// Returns the numbers of calls that failed, in all scenes.
    FailingScene::Failures failures() const;

private:
    struct Object {
        ObjectId id;
        Box3d box;    ///< for the next step
        Box3d place;  ///< for steps after that
        double padding = 0;
    };
    struct JudgedScene {
        std::string name;
        StepChoice choice;
        FailingScene scene;
    };

    void make_scenes(unsigned threads);
    template <typename Call>
    void for_each_scene(const std::vector<Box3d>& boxes, Call&& call);

    void change();
    void add(std::vector<Object> added);
    void add_some(std::uint64_t count);
    void remove_some(std::uint64_t count);
    void move_some(std::uint64_t count, bool swept, bool far);
    Object& any_object();
    std::vector<ObjectId> some_ids(std::uint64_t count);
    Box3d moved(const Box3d& box, bool far);

    /// Returns all pairs of the current objects, ascending, by the second algorithm. Sets too_many_.
    std::vector<Pair> find_pairs();
    void make_step(bool last);
    void check_step(JudgedScene& judged, bool read);

    samples::RandomStream random_;
    bool float64_ = false, padded_ = false, too_many_ = false;
    double margin_ = 0;
    std::vector<std::optional<Object>> objects_;  // by index
    std::vector<JudgedScene> scenes_;
    std::vector<Pair> before_, now_;  // true pairs of the last step, and of the next step
    std::uint64_t full_steps_ = 0, partial_steps_ = 0;
};

}  // namespace octopair::test
