// Random histories of a scene: additions, moves, sweeps, removals and new traits. Brute force checks each step, and the
// queries between steps if the scene answers queries. Boxes are of a kind (kinds.hpp) or a family (families.hpp).
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <random>
#include <stop_token>
#include <string>
#include <vector>

#include "scene/model.hpp"
#include "scene/query_model.hpp"
#include "support/errors.hpp"
#include "support/families.hpp"
#include "support/kinds.hpp"

namespace octopair::test {

/// Boxes of a history: an endless sequence of a kind, or the boxes of one scene of a family, each time in a new order.
class BoxSource {
public:
    /// `name`: name of a kind or a family. `scene_objects`: number of boxes of a scene.
    BoxSource(const std::string& name, std::uint64_t scene_objects) : name_(name), objects_(scene_objects) {
        const auto families = family_names();
        is_family_ = std::find(families.begin(), families.end(), name) != families.end();
    }
    /// Makes the first boxes. Without `float64`, all coordinates are float32 values. Requires: called before the first
    /// next().
    void begin(bool float64, std::mt19937_64& random) {
        float64_ = float64;
        renew(random);
    }
    Box3d next(std::mt19937_64& random) {
        if (next_ == boxes_.size()) renew(random);
        return boxes_[next_++];
    }
    /// Returns a clearance that adds pairs, but does not make all objects pairs.
    double clearance() const { return is_family_ ? clearance_ : 0.5; }

private:
    void renew(std::mt19937_64& random) {
        next_ = 0;
        if (!is_family_) {
            boxes_ = float64_ ? make_double_boxes(name_, objects_, random())
                              : widened(make_boxes(name_, objects_, random()));
        } else if (boxes_.empty()) {
            take_family(make_family_case(name_, objects_, random()));
        } else {
            std::shuffle(boxes_.begin(), boxes_.end(), random);
        }
    }
    void take_family(const Case& a_case) {
        const auto append = [&](const auto& boxes) {
            for (const auto& box : boxes) {
                const Box3d wide{{box.min[0], box.min[1], box.min[2]}, {box.max[0], box.max[1], box.max[2]}};
                boxes_.push_back(float64_ ? wide : rounded_to_float32(wide));
            }
        };
        std::visit(append, a_case.first.boxes);
        if (a_case.second) std::visit(append, a_case.second->boxes);
        for (int axis = 0; axis < 3; ++axis) {
            clearance_ = std::max(clearance_, (boxes_[0].max[axis] - boxes_[0].min[axis]) / 4);
        }
    }

    std::string name_;
    std::uint64_t objects_;
    bool is_family_, float64_ = false;
    std::vector<Box3d> boxes_;
    std::size_t next_ = 0;
    double clearance_ = 0;
};

/// The size of a history.
struct HistorySize {
    std::uint64_t objects = 320;  ///< bound on the number of objects at first
    int steps = 25;
};

/// A scene and its model, which get the same calls. AnyScene: a class with the calls of Scene.
template <typename AnyScene>
class History {
public:
    /// `name`: name of a kind or a family. `make` makes the scene from SceneOptions.
    template <typename Make>
    History(const std::string& name, std::uint64_t seed, Make&& make, const HistorySize& size = {})
        : random_(seed), size_(size), boxes_(name, size.objects + 80) {
        float64_ = chance(0.4);
        padded_ = chance(0.3);
        with_traits_ = chance(0.5);
        const bool with_margin = chance(0.3);
        queried_ = chance(0.5);
        boxes_.begin(float64_, random_);
        margin_ = with_margin ? boxes_.clearance() : 0;
        model_ = Model(margin_);
        const double slack = chance(0.5) ? boxes_.clearance() * double(random_() % 9) / 4 : 0;
        SceneOptions options{unsigned(1 + random_() % 3), float64_ ? Precision::float64 : Precision::float32, margin_};
        options.slack = std::isfinite(slack) ? slack : 0;
        scene_ = make(options);
    }

    void run() {
        const std::uint64_t least = std::min<std::uint64_t>(20, size_.objects / 2);
        add(least + random_() % (size_.objects - least));
        for (int i = 0; i < size_.steps; ++i) {
            if (chance(0.2)) cancel_step();
            if (::testing::Test::HasFatalFailure()) return;
            model_.check(scene_);
            if (::testing::Test::HasFatalFailure()) return;
            // Reads the lists at some steps only, so that the list merges the changes of several steps at once.
            if (i + 1 == size_.steps || chance(0.5)) model_.check_lists(scene_);
            if (::testing::Test::HasFatalFailure()) return;
            settle();
            check_queries();
            if (::testing::Test::HasFatalFailure()) return;
            change();
            check_queries();
            if (::testing::Test::HasFatalFailure()) return;
        }
    }

    const Model& model() const { return model_; }
    AnyScene& scene() { return scene_; }

private:
    bool chance(double part) { return std::uniform_real_distribution<>(0, 1)(random_) < part; }

    void change() {
        const std::uint64_t most = chance(0.1) ? 1 + model_.objects.size() : 6;
        if (chance(0.3)) add(random_() % most);
        if (chance(0.8)) move(random_() % most, false);
        if (chance(0.3)) remove(random_() % most);
        if (chance(0.2)) move(random_() % most, true);
        if (chance(0.3)) move(random_() % most, false);
        if (with_traits_ && chance(0.3)) set_traits(random_() % most);
    }

    /// Cancels a step at its begin. Later calls of the scene must not show a difference.
    void cancel_step() {
        (void)error_of(ErrorCode::cancelled, [&] { (void)scene_.step(requested_stop()); });
        check_queries();
    }

    /// Checks queries in some histories and at some steps only: queries may build an octree, which the next step does
    /// not use.
    void check_queries() {
        if constexpr (requires { scene_.overlaps(Box3d(), 0u); }) {
            if (queried_ && chance(0.3)) QueryModel(model_, scene_, random_()).check();
        }
    }

    Box3d next_box() { return boxes_.next(random_); }

    Traits random_traits() {
        Traits traits;
        if (!with_traits_) return traits;
        traits.groups = 1u << random_() % 3;
        if (chance(0.3)) traits.mask = random_() % 8;
        traits.fixed = chance(0.3);
        return traits;
    }

    /// Calls body(boxes) with boxes of the scene's precision.
    template <typename Body>
    void with_boxes(const std::vector<Box3d>& boxes, Body&& body) {
        if (float64_) return body(Boxes(std::span(boxes)));
        std::vector<Box3f> narrow;
        for (const Box3d& box : boxes) narrow.push_back(narrowed(box));
        body(Boxes(std::span<const Box3f>(narrow)));
    }

    void add(std::uint64_t count) {
        std::vector<Box3d> boxes;
        std::vector<double> paddings;
        std::vector<Traits> traits;
        for (std::uint64_t i = 0; i < count; ++i) {
            boxes.push_back(next_box());
            if (padded_) paddings.push_back(double(random_() % 3) / 4 * boxes_.clearance());
            traits.push_back(random_traits());
        }
        std::vector<ObjectId> ids(count);
        with_boxes(boxes, [&](const Boxes& all) { scene_.add(Objects{all, paddings}, ids, traits); });
        for (std::uint64_t i = 0; i < count; ++i) {
            ASSERT_FALSE(model_.objects.contains(ids[i].index));
            model_.objects[ids[i].index] = {ids[i], boxes[i], padded_ ? paddings[i] : 0, traits[i]};
        }
    }

    std::vector<ObjectId> some(std::uint64_t count) {
        std::vector<ObjectId> ids;
        for (std::uint64_t i = 0; i < count && !model_.objects.empty(); ++i) {
            auto at = model_.objects.lower_bound(std::uint32_t(random_() % scene_.indices()));
            if (at == model_.objects.end()) at = model_.objects.begin();
            ids.push_back(at->second.id);
        }
        return ids;
    }

    void move(std::uint64_t count, bool swept) {
        const std::vector<ObjectId> ids = some(count);
        std::vector<Box3d> boxes;
        for (const ObjectId id : ids) {
            Box3d box = next_box();
            if (chance(0.5)) {  // a small move along x
                box = model_.objects[id.index].box;
                const double way = (box.max[0] - box.min[0]) * (double(random_() % 5) - 2) / 4;
                box.min[0] += way;
                box.max[0] = std::max(box.min[0], box.max[0] + way);
                if (!std::isfinite(float(box.min[0])) || !std::isfinite(float(box.max[0]))) box = next_box();
                if (!float64_) box = rounded_to_float32(box);
            }
            boxes.push_back(box);
        }
        with_boxes(boxes, [&](const Boxes& all) { swept ? scene_.sweep(ids, all) : scene_.move(ids, all); });
        for (std::size_t i = 0; i < ids.size(); ++i) {
            Box3d& box = model_.objects[ids[i].index].box;
            places_.erase(ids[i].index);
            if (!swept) {
                box = boxes[i];
                continue;
            }
            places_[ids[i].index] = boxes[i];
            for (int axis = 0; axis < 3; ++axis) {
                box.min[axis] = std::min(box.min[axis], boxes[i].min[axis]);
                box.max[axis] = std::max(box.max[axis], boxes[i].max[axis]);
            }
        }
    }

    /// After a step, moves each swept object to the end of its sweep.
    void settle() {
        for (const auto& [index, box] : places_) {
            if (model_.objects.contains(index)) model_.objects[index].box = box;
        }
        places_.clear();
    }

    void remove(std::uint64_t count) {
        std::vector<ObjectId> ids = some(count);
        std::sort(ids.begin(), ids.end());
        ids.erase(std::unique(ids.begin(), ids.end()), ids.end());
        scene_.remove(ids);
        for (const ObjectId id : ids) {
            EXPECT_FALSE(scene_.contains(id));
            model_.objects.erase(id.index);
            places_.erase(id.index);
        }
    }

    void set_traits(std::uint64_t count) {
        const std::vector<ObjectId> ids = some(count);
        std::vector<Traits> traits;
        for (std::size_t i = 0; i < ids.size(); ++i) traits.push_back(random_traits());
        if (ids.empty()) return;
        scene_.set_traits(ids, traits);
        for (std::size_t i = 0; i < ids.size(); ++i) model_.objects[ids[i].index].traits = traits[i];
    }

    std::mt19937_64 random_;
    HistorySize size_;
    BoxSource boxes_;
    bool float64_ = false, padded_ = false, with_traits_ = false, queried_ = false;
    double margin_ = 0;
    Model model_;
    AnyScene scene_;
    std::map<std::uint32_t, Box3d> places_;
};

}  // namespace octopair::test
