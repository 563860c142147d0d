#include "exactness/large_history.hpp"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <exception>
#include <iterator>
#include <sstream>
#include <utility>

#include "base/test_hooks.hpp"
#include "parallel/team.hpp"
#include "support/compare.hpp"
#include "support/families.hpp"
#include "support/kinds.hpp"
#include "verification/row_search.hpp"

namespace octopair::test {

namespace {

std::vector<Box3d> boxes_of(const Case& a_case) {
    std::vector<Box3d> boxes;
    const auto append = [&](const auto& owned) {
        for (const auto& box : owned) {
            boxes.push_back({{box.min[0], box.min[1], box.min[2]}, {box.max[0], box.max[1], box.max[2]}});
        }
    };
    std::visit(append, a_case.first.boxes);
    if (a_case.second) std::visit(append, a_case.second->boxes);
    return boxes;
}

std::vector<double> paddings_of(const Case& a_case, std::size_t objects) {
    std::vector<double> paddings(a_case.first.padding);
    paddings.resize(a_case.first.view().size());
    if (a_case.second) paddings.insert(paddings.end(), a_case.second->padding.begin(), a_case.second->padding.end());
    paddings.resize(objects);
    return paddings;
}

std::vector<Box3f> all_narrowed(const std::vector<Box3d>& boxes) {
    std::vector<Box3f> narrow;
    for (const Box3d& box : boxes) narrow.push_back(narrowed(box));
    return narrow;
}

Box3d joined(Box3d a, const Box3d& b) {
    for (int axis = 0; axis < 3; ++axis) {
        a.min[axis] = std::min(a.min[axis], b.min[axis]);
        a.max[axis] = std::max(a.max[axis], b.max[axis]);
    }
    return a;
}

std::vector<Pair> without(const std::vector<Pair>& all, const std::vector<Pair>& less) {
    std::vector<Pair> rest;
    std::set_difference(all.begin(), all.end(), less.begin(), less.end(), std::back_inserter(rest));
    return rest;
}

void expect_same(const std::string& check, const std::vector<Pair>& found, const std::vector<Pair>& expected) {
    const auto result = same_bytes(found, expected);
    if (!result) throw Finding{check, result.message()};
}

void expect_same(const std::string& check, std::uint64_t found, std::uint64_t expected) {
    if (found != expected) throw Finding{check, std::to_string(found) + ", not " + std::to_string(expected)};
}

std::vector<Pair> vector_of(std::span<const Pair> pairs) { return {pairs.begin(), pairs.end()}; }

}  // namespace

LargeHistory::LargeHistory(const std::string& family, std::uint64_t objects, std::uint64_t seed) : random_(seed, 3) {
    const Case a_case = make_family_case(family, objects, seed);
    float64_ = a_case.first.boxes.index() == 1 || (a_case.second && a_case.second->boxes.index() == 1);
    padded_ = !a_case.first.padding.empty() || (a_case.second && !a_case.second->padding.empty());
    margin_ = a_case.margin;
    make_scenes(a_case.threads[0]);
    const std::vector<Box3d> boxes = boxes_of(a_case);
    const std::vector<double> paddings = paddings_of(a_case, boxes.size());
    std::vector<Object> added;
    for (std::size_t i = 0; i < boxes.size(); ++i) added.push_back({{}, boxes[i], boxes[i], paddings[i]});
    add(std::move(added));
    now_ = find_pairs();
}

void LargeHistory::make_scenes(unsigned threads) {
    SceneOptions options{
        .threads = threads, .precision = float64_ ? Precision::float64 : Precision::float32, .margin = margin_};
    const double failing = random_.below(2) == 0 ? 0 : 0.3;
    const auto make = [&](const char* name, StepChoice choice) {
        scenes_.push_back({name, choice, FailingScene(options, random_.below(1'000'000), failing)});
    };
    const bool measured = random_.below(4) == 0;
    if (!has_test_hooks) return make("measured", StepChoice::measured);
    measured ? make("measured", StepChoice::measured) : make("incremental", StepChoice::incremental);
    make("full", StepChoice::full);
}

std::string LargeHistory::describe() const {
    std::ostringstream text;
    text << objects_.size() << (float64_ ? " float64" : " float32") << " boxes" << (padded_ ? " with padding" : "")
         << ", margin " << margin_;
    return text.str();
}

FailingScene::Failures LargeHistory::failures() const {
    FailingScene::Failures failures;
    for (const JudgedScene& judged : scenes_) failures.add(judged.scene.failures());
    return failures;
}

std::optional<Finding> LargeHistory::run() {
    for (int step = 0; step < steps && !too_many_; ++step) {
        const auto found = [&](const std::string& check, const std::string& text) {
            return Finding{check, "step " + std::to_string(step) + ": " + text};
        };
        try {
            make_step(step + 1 == steps);
        } catch (const Finding& finding) {
            return found(finding.check, finding.text);
        } catch (const std::exception& error) {
            return found("an error", error.what());
        }
    }
    return {};
}

/// Compares a step of each scene with the true pairs, and makes the changes for the next step.
void LargeHistory::make_step(bool last) {
    const bool read = last || random_.below(3) != 0;  // unread pairs wait to be merged into the list
    for (JudgedScene& judged : scenes_) check_step(judged, read);
    before_ = std::move(now_);
    for (auto& object : objects_) {
        if (object) object->box = object->place;
    }
    if (last) return;
    change();
    now_ = find_pairs();
}

void LargeHistory::check_step(JudgedScene& judged, bool read) {
#ifdef OCTOPAIR_TEST_HOOKS
    test_hooks().tuning.scene.step = judged.choice;
#endif
    const StepResult& result = judged.scene.step();
    ++(result.full ? full_steps_ : partial_steps_);
    const std::string where = judged.name + " scene, " + (result.full ? "full" : "partial") + " step: ";
    const std::vector<Pair> began = without(now_, before_);
    expect_same(where + "began", vector_of(result.began), began);
    expect_same(where + "ended", vector_of(result.ended), without(before_, now_));
    expect_same(where + "persisting", result.persisting, now_.size() - began.size());
    if (!read) return;
    expect_same(where + "pairs()", judged.scene.pairs().to_vector(), now_);
    expect_same(where + "persisting()", judged.scene.persisting().to_vector(), without(now_, began));
}

std::vector<Pair> LargeHistory::find_pairs() {
    static Team team(2);
    std::vector<std::uint32_t> indices;
    std::vector<Box3d> boxes;
    std::vector<double> paddings;
    for (std::uint32_t index = 0; index < objects_.size(); ++index) {
        if (!objects_[index]) continue;
        indices.push_back(index);
        boxes.push_back(objects_[index]->box);
        if (padded_) paddings.push_back(objects_[index]->padding);
    }
    const Objects objects{boxes, paddings};
    const RowSearch search({objects, nullptr, margin_}, team);
    constexpr std::uint32_t block_rows = 1024;
    std::vector<std::vector<Pair>> blocks((search.rows() + block_rows - 1) / block_rows);
    std::atomic<std::uint64_t> size = 0;
    team.for_each(blocks.size(), [&](std::size_t block, unsigned) {
        std::vector<std::uint32_t> columns;
        const std::uint32_t begin = std::uint32_t(block) * block_rows,
                            end = std::min(begin + block_rows, search.rows());
        for (std::uint32_t a = begin; a < end && size < max_pairs_per_object * search.rows(); ++a) {
            search.row(a, columns);
            size += columns.size();
            for (const std::uint32_t b : columns) blocks[block].push_back({indices[a], indices[b]});
        }
    });
    too_many_ = size >= max_pairs_per_object * search.rows();
    std::vector<Pair> pairs;
    pairs.reserve(size);
    for (const auto& block : blocks) pairs.insert(pairs.end(), block.begin(), block.end());
    return pairs;
}

/// Calls call(scene, boxes) with boxes in the precision of the scenes.
template <typename Call>
void LargeHistory::for_each_scene(const std::vector<Box3d>& boxes, Call&& call) {
    const std::vector<Box3f> narrow = float64_ ? std::vector<Box3f>{} : all_narrowed(boxes);
    for (JudgedScene& judged : scenes_) {
        float64_ ? call(judged.scene, Boxes(std::span(boxes))) : call(judged.scene, Boxes(std::span(narrow)));
    }
}

void LargeHistory::change() {
    const double part = std::pow(10.0, random_.uniform(-4, std::log10(0.3)));
    const auto count = std::uint64_t(std::ceil(part * double(objects_.size())));
    move_some(count, false, random_.below(3) == 0);
    if (random_.below(3) == 0) move_some(1 + count / 8, false, true);
    if (random_.below(3) == 0) move_some(1 + count / 4, true, false);
    if (random_.below(3) == 0) move_some(1 + random_.below(3), true, true);
    if (random_.below(2) == 0) remove_some(1 + random_.below(1 + count / 2));
    if (random_.below(2) == 0) add_some(1 + random_.below(1 + count / 2));
    if (random_.below(4) == 0) move_some(1 + count / 4, false, false);
}

void LargeHistory::add(std::vector<Object> added) {
    std::vector<Box3d> boxes;
    std::vector<double> paddings;
    for (const Object& object : added) {
        boxes.push_back(object.box);
        if (padded_) paddings.push_back(object.padding);
    }
    std::vector<ObjectId> ids(added.size());
    for_each_scene(boxes, [&](FailingScene& scene, const Boxes& all) { scene.add({all, paddings}, ids); });
    for (std::size_t i = 0; i < added.size(); ++i) {
        if (ids[i].index >= objects_.size()) objects_.resize(ids[i].index + 1);
        added[i].id = ids[i];
        objects_[ids[i].index] = added[i];
    }
}

void LargeHistory::add_some(std::uint64_t count) {
    std::vector<Object> added;
    for (std::uint64_t i = 0; i < count; ++i) {
        const Box3d box = moved(any_object().place, true);
        added.push_back({{}, box, box, any_object().padding});
    }
    add(std::move(added));
}

void LargeHistory::remove_some(std::uint64_t count) {
    std::vector<ObjectId> ids = some_ids(std::min<std::uint64_t>(count, objects_.size() / 2));
    std::sort(ids.begin(), ids.end());
    ids.erase(std::unique(ids.begin(), ids.end()), ids.end());
    for (JudgedScene& judged : scenes_) judged.scene.remove(ids);
    for (const ObjectId& id : ids) objects_[id.index].reset();
}

void LargeHistory::move_some(std::uint64_t count, bool swept, bool far) {
    const std::vector<ObjectId> ids = some_ids(count);
    std::vector<Box3d> boxes;
    for (const ObjectId& id : ids) {
        Object& object = *objects_[id.index];
        object.place = moved(object.place, far);
        object.box = swept ? joined(object.box, object.place) : object.place;
        boxes.push_back(object.place);
    }
    for_each_scene(
        boxes, [&](FailingScene& scene, const Boxes& all) { swept ? scene.sweep(ids, all) : scene.move(ids, all); });
}

LargeHistory::Object& LargeHistory::any_object() {
    while (true) {
        auto& object = objects_[random_.below(objects_.size())];
        if (object) return *object;
    }
}

/// Returns random ids, scattered or consecutive. Some may repeat.
std::vector<ObjectId> LargeHistory::some_ids(std::uint64_t count) {
    std::vector<ObjectId> ids;
    if (random_.below(2) == 0) {
        for (std::uint64_t i = 0; i < count; ++i) ids.push_back(any_object().id);
        return ids;
    }
    std::uint64_t index = random_.below(objects_.size());
    for (std::uint64_t i = 0; i < count; ++i, index = (index + 1) % objects_.size()) {
        if (objects_[index]) ids.push_back(objects_[index]->id);
    }
    return ids;
}

/// Returns `box` moved by up to half its size, or so that it touches its old place. With `far`, the move starts
/// at the place of another object.
Box3d LargeHistory::moved(const Box3d& box, bool far) {
    const bool touches = random_.below(8) == 0;
    const Box3d other = far ? any_object().place : box;
    if (far && random_.below(8) == 0) return other;
    Box3d result = box;
    for (int axis = 0; axis < 3; ++axis) {
        const double side = box.max[axis] - box.min[axis];
        const double way = touches ? side : side * random_.uniform(-0.5, 0.5);
        const double to = other.min[axis] + way;
        result.min[axis] = to;
        result.max[axis] = touches ? std::max(to, box.max[axis] + (to - box.min[axis])) : to + side;
    }
    return float64_ ? result : rounded_to_float32(result);
}

}  // namespace octopair::test
