#include "scene/scene_objects.hpp"

#include <algorithm>
#include <cmath>
#include <string>

#include "base/growing_array.hpp"
#include "octopair/error.hpp"

namespace octopair {

namespace {

constexpr std::size_t ahead = 24;  // objects of a call that are prefetched before they are processed

PlacedError fault(std::size_t position, const std::string& what) {
    return {ErrorCode::bad_input,
            "object " + std::to_string(position) + " of the call: " + what,
            {.index = position, .set = 0, .frame = {}}};
}

std::uint64_t size_of(const Boxes& boxes) {
    return std::visit([](auto span) -> std::uint64_t { return span.size(); }, boxes);
}

Box3d joined(const Box3d& a, const Box3d& b) {
    Box3d both;
    for (int axis = 0; axis < 3; ++axis) {
        both.min[axis] = std::min(a.min[axis], b.min[axis]);
        both.max[axis] = std::max(a.max[axis], b.max[axis]);
    }
    return both;
}

/// Returns the traits of object `i`. `traits` is empty (defaults), has one element for all objects, or one for each.
const Traits& traits_at(std::span<const Traits> traits, std::size_t i) {
    static constexpr Traits defaults{};
    return traits.empty() ? defaults : traits[traits.size() == 1 ? 0 : i];
}

}  // namespace

SceneObjects::SceneObjects(const SceneOptions& options, Changes changes)
    : float64_(options.precision == Precision::float64), table_(options.precision, options.slack), changes_(changes) {
    const auto check = [](const char* name, double length) {
        if (length >= 0 && std::isfinite(length)) return;
        throw Error(ErrorCode::bad_input, name + (" is " + std::to_string(length)) + ", not a finite number >= 0");
    };
    check("margin", options.margin);
    check("slack", options.slack);
    if (changes_ == Changes::forgotten) log_.give_up(table_);
}

ObjectId SceneObjects::id(std::uint32_t index) const {
    if (index >= table_.indices() || !table_.alive(index)) {
        throw Error(ErrorCode::bad_input, "no object has the index " + std::to_string(index));
    }
    return table_.id(index);
}

void SceneObjects::check_boxes(const Boxes& boxes, std::size_t expected) const {
    if (size_of(boxes) != expected) {
        throw Error(ErrorCode::bad_input,
                    std::to_string(size_of(boxes)) + " boxes for " + std::to_string(expected) + " ids");
    }
    if (std::holds_alternative<std::span<const Box3d>>(boxes) != float64_) {
        throw Error(ErrorCode::bad_input, std::string("boxes are float") + (float64_ ? "32" : "64") +
                                              ", the scene's float" + (float64_ ? "64" : "32"));
    }
    const auto check = [](const auto& span) {
        if (are_boxes(span)) return;
        const auto wrong = std::find_if_not(span.begin(), span.end(), [](const auto& box) { return is_box(box); });
        throw fault(std::size_t(wrong - span.begin()), "not a finite box with min <= max");
    };
    std::visit(check, boxes);
}

void SceneObjects::check_ids(std::span<const ObjectId> ids) const {
    for (std::size_t i = 0; i < ids.size(); ++i) {
        if (i + ahead < ids.size()) table_.prefetch_slot(ids[i + ahead].index);
        if (table_.contains(ids[i])) continue;
        throw fault(i, "id " + std::to_string(ids[i].index) + "." + std::to_string(ids[i].generation) +
                           " names no object of the scene");
    }
}

void SceneObjects::check_paddings(std::span<const double> paddings, std::size_t objects) const {
    if (!paddings.empty() && paddings.size() != objects) {
        throw Error(ErrorCode::bad_input,
                    std::to_string(paddings.size()) + " paddings for " + std::to_string(objects) + " objects");
    }
    for (std::size_t i = 0; i < paddings.size(); ++i) {
        if (!is_padding(paddings[i])) throw fault(i, "padding is not a finite number >= 0");
    }
}

void SceneObjects::add(const Objects& objects, std::span<ObjectId> ids, std::span<const Traits> traits) {
    check_boxes(objects.boxes, ids.size());
    check_paddings(objects.padding, ids.size());
    if (traits.size() > 1 && traits.size() != ids.size()) {
        throw Error(ErrorCode::bad_input,
                    std::to_string(traits.size()) + " traits for " + std::to_string(ids.size()) + " objects");
    }
    if (table_.indices() + ids.size() >= ObjectTable::none) throw Error(ErrorCode::resource_limit, "too many objects");
    const auto padded = [](double padding) { return padding > 0; };
    const auto unusual = [](const Traits& one) { return one != Traits{}; };
    table_.reserve(ids.size(), std::any_of(objects.padding.begin(), objects.padding.end(), padded),
                   std::any_of(traits.begin(), traits.end(), unusual));
    prepare(ids.size());
    if (recorder_ != nullptr) recorder_->add(objects, traits);
    std::visit([&](auto boxes) { add_all(boxes, objects.padding, traits, ids); }, objects.boxes);
}

/// Reserves log memory for changes, so that they cannot fail.
void SceneObjects::prepare(std::uint64_t changes) { log_.reserve(table_, changes); }

/// Logs the object's state before a move. With slack, logs nothing: update_searched() later logs the objects that left their searched box.
void SceneObjects::note_move(std::uint32_t index) {
    if (!table_.has_slack()) log_.note(table_, index, true);
}

void SceneObjects::update_searched() {
    if (!table_.has_slack() || !changed()) return;
    table_.find_outside(outside_);
    prepare(outside_.size());
    if (log_.overflowed()) return table_.enlarge_all();
    for (const std::uint32_t index : outside_) {
        log_.note(table_, index, true);
        table_.enlarge(index);
    }
}

template <typename Real>
void SceneObjects::add_all(std::span<const Box<Real>> boxes, std::span<const double> paddings,
                           std::span<const Traits> traits, std::span<ObjectId> ids) {
    for (std::size_t i = 0; i < ids.size(); ++i) {
        ids[i] = table_.create(boxes[i], paddings.empty() ? 0 : paddings[i], traits_at(traits, i));
        log_.note(table_, ids[i].index, false);
    }
    is_changed_by_call_ |= !ids.empty();
}

void SceneObjects::move(std::span<const ObjectId> ids, const Boxes& boxes, bool swept) {
    check_boxes(boxes, ids.size());
    check_ids(ids);
    if (swept) {
        reserve_more(swept_, ids.size());
        settled_.reserve(swept_.capacity());
        if (swept_at_.size() < table_.indices()) swept_at_.resize(std::size_t(table_.indices()), ObjectTable::none);
    }
    if (!table_.has_slack()) prepare(ids.size());
    if (recorder_ != nullptr) recorder_->move(swept ? RecordKind::sweep : RecordKind::move, ids, boxes);
    std::visit([&](auto span) { swept ? sweep_to(ids, span) : move_to(ids, span); }, boxes);
}

template <typename Real>
void SceneObjects::move_to(std::span<const ObjectId> ids, std::span<const Box<Real>> boxes) {
    const bool any_swept = !swept_.empty();
    for (std::size_t i = 0; i < ids.size(); ++i) {
        const std::uint32_t index = ids[i].index;
        if (i + ahead < ids.size()) table_.prefetch(ids[i + ahead].index);
        if (any_swept) drop_swept(index);
        if (!table_.has_box(index, boxes[i])) {
            note_move(index);
            is_changed_by_call_ = true;
        }
        table_.set_box(index, boxes[i]);  // also if the boxes are equal, because 0 may become -0
    }
}

template <typename Real>
void SceneObjects::sweep_to(std::span<const ObjectId> ids, std::span<const Box<Real>> boxes) {
    for (std::size_t i = 0; i < ids.size(); ++i) {
        const std::uint32_t index = ids[i].index;
        note_move(index);
        drop_swept(index);
        swept_at_[index] = std::uint32_t(swept_.size());
        swept_.push_back({ids[i], wide(boxes[i])});
        table_.set_box(index, joined(table_.box(index), wide(boxes[i])));
    }
    is_changed_by_call_ |= !ids.empty();
}

void SceneObjects::drop_swept(std::uint32_t index) {
    if (index >= swept_at_.size() || swept_at_[index] == ObjectTable::none) return;
    swept_[swept_at_[index]].id = {};
    swept_at_[index] = ObjectTable::none;
}

void SceneObjects::check_removal(std::span<const ObjectId> ids) {
    check_ids(ids);
    sorted_.assign(ids.begin(), ids.end());
    std::sort(sorted_.begin(), sorted_.end());
    const auto twice = std::adjacent_find(sorted_.begin(), sorted_.end());
    if (twice != sorted_.end()) {
        throw PlacedError(ErrorCode::bad_input,
                          "id " + std::to_string(twice->index) + "." + std::to_string(twice->generation) +
                              " is listed twice; list each object to remove once",
                          {.index = twice->index, .set = 0, .frame = {}});
    }
}

void SceneObjects::remove(std::span<const ObjectId> ids) {
    check_removal(ids);
    reserve_more(removed_, ids.size());
    table_.reserve_release(removed_.size() + ids.size());
    prepare(ids.size());
    if (recorder_ != nullptr) recorder_->remove(ids);
    for (const ObjectId& id : ids) {
        log_.note(table_, id.index, true);
        drop_swept(id.index);
        table_.kill(id.index);
        removed_.push_back(id.index);
        is_changed_by_call_ = true;
    }
}

void SceneObjects::set_traits(std::span<const ObjectId> ids, std::span<const Traits> traits) {
    if (traits.size() != 1 && traits.size() != ids.size()) {
        throw Error(ErrorCode::bad_input,
                    std::to_string(traits.size()) + " traits for " + std::to_string(ids.size()) + " ids");
    }
    check_ids(ids);
    if (std::any_of(traits.begin(), traits.end(), [](const Traits& one) { return one != Traits{}; })) {
        table_.reserve(0, false, true);
    }
    prepare(ids.size());
    if (recorder_ != nullptr) recorder_->set_traits(ids, traits);
    for (std::size_t i = 0; i < ids.size(); ++i) {
        log_.note(table_, ids[i].index, true);
        table_.set_traits(ids[i].index, traits_at(traits, i));
        is_changed_by_call_ = true;
    }
}

void SceneObjects::enlarge_all() {
    if (!table_.has_slack() || log_.overflowed()) return;  // update_searched() has enlarged all boxes
    log_.give_up(table_);
    table_.enlarge_all();
}

bool SceneObjects::finish_step() {
    if (changes_ == Changes::kept) log_.clear(table_);
    for (const std::uint32_t index : removed_) table_.release(index);
    removed_.clear();
    settled_.clear();
    is_changed_by_call_ = false;
    return finish_sweeps();
}

/// Sets the box of each swept object to the box at the end of its sweep. For the log, this is a change after the step.
bool SceneObjects::finish_sweeps() {
    if (swept_.empty()) return false;
    if (!table_.has_slack()) prepare(swept_.size());
    for (const Swept& swept : swept_) {
        if (!table_.contains(swept.id)) continue;
        swept_at_[swept.id.index] = ObjectTable::none;
        note_move(swept.id.index);
        settled_.push_back({swept.id.index, table_.box(swept.id.index)});
        table_.set_box(swept.id.index, swept.place);
    }
    swept_.clear();
    return true;
}

}  // namespace octopair
