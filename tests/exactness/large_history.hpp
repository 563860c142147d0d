// LargeHistory: a scene of many objects that move, come and go, held step by step against the second algorithm
// (src/verification).
//
// Objects    those of a random call of a family (support/families.hpp); the two sets of a join are one scene.
// Scenes     with test hooks two scenes get the same calls: one searches around changes where it can, the other one
//            searches all objects at each step. Without, one scene chooses by itself.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "base/tuning.hpp"
#include "exactness/case_check.hpp"
#include "octopair/octopair.hpp"
#include "samples/random.hpp"
#include "support/cases.hpp"

namespace octopair::test {

class LargeHistory {
public:
    static constexpr int steps = 6;
    static constexpr std::uint64_t most_pairs_an_object = 60;

    /// A pure function of its arguments. `objects`: about how many.
    LargeHistory(const std::string& family, std::uint64_t objects, std::uint64_t seed);

    /// Whether there are so many pairs that the second algorithm would take too long.
    bool has_too_many_pairs() const { return too_many_; }
    /// Makes all steps, or fewer if there come to be too many pairs. Returns the first finding. Requires: not too many pairs
    /// at first. To be called once.
    std::optional<Finding> run();

    std::string describe() const;
    std::uint64_t full_steps() const { return full_steps_; }
    std::uint64_t partial_steps() const { return partial_steps_; }

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
        Scene scene;
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

    /// All pairs of the objects as they are, ascending, by the second algorithm. Sets too_many_.
    std::vector<Pair> find_pairs();
    void make_step(bool last);
    void check_step(JudgedScene& judged, bool read);

    samples::RandomStream random_;
    bool float64_ = false, padded_ = false, too_many_ = false;
    double margin_ = 0;
    std::vector<std::optional<Object>> objects_;  // by index
    std::vector<JudgedScene> scenes_;
    std::vector<Pair> before_, now_;  // true pairs of the last step, and of the next one
    std::uint64_t full_steps_ = 0, partial_steps_ = 0;
};

}  // namespace octopair::test
