#include "octopair/scene.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <new>
#include <string>

#include "engine/local/ascending.hpp"
#include "geometry/query_rules.hpp"
#include "octopair/error.hpp"
#include "octree/linear_octree.hpp"
#include "octree/mutable_octree.hpp"
#include "octree/scan.hpp"
#include "scene/change_search.hpp"
#include "scene/recorder.hpp"
#include "scene/scene_queries.hpp"
#include "scene/scene_source.hpp"

namespace octopair {

namespace {

constexpr double worth_it = 0.9;     // of a full detection may the search for changes cost, as far as is known
constexpr double guessed_cost = 10;  // of an object that changed, in those of one in a full detection
constexpr std::size_t ahead = 24;    // objects of a call that are fetched before their turn
constexpr double few_moved = 0.05;   // of the objects: an octree for the next step pays

double seconds_since(std::chrono::steady_clock::time_point begin) {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
}

Error fault(std::size_t position, const std::string& what) {
    return {ErrorCode::bad_input, "object " + std::to_string(position) + " of the call: " + what};
}

std::uint64_t size_of(const Boxes& boxes) {
    return std::visit([](auto span) -> std::uint64_t { return span.size(); }, boxes);
}

Box3d box_at(const Boxes& boxes, std::size_t i) {
    return std::visit([&](auto span) { return wide(span[i]); }, boxes);
}

Box3d joined(const Box3d& a, const Box3d& b) {
    Box3d both;
    for (int axis = 0; axis < 3; ++axis) {
        both.min[axis] = std::min(a.min[axis], b.min[axis]);
        both.max[axis] = std::max(a.max[axis], b.max[axis]);
    }
    return both;
}

template <typename Query, typename IsOne>
void check_queries(std::span<const Query> queries, IsOne&& is_one) {
    const auto wrong = std::find_if_not(queries.begin(), queries.end(), is_one);
    if (wrong == queries.end()) return;
    throw Error(ErrorCode::bad_input, "query " + std::to_string(wrong - queries.begin()) + " of the call is not valid");
}

/// None for the defaults, one for all, or one for each.
const Traits& traits_at(std::span<const Traits> traits, std::size_t i) {
    static constexpr Traits defaults{};
    return traits.empty() ? defaults : traits[traits.size() == 1 ? 0 : i];
}

}  // namespace

class Scene::State {
public:
    explicit State(const SceneOptions& options)
        : margin_(options.margin),
          float64_(options.precision == Precision::float64),
          table_(options.precision),
          team_(options.threads),
          search_(team_),
          queries_(team_) {
        if (!(margin_ >= 0 && std::isfinite(margin_))) {
            throw Error(ErrorCode::bad_input, "margin is " + std::to_string(margin_) + ", not a finite number >= 0");
        }
        if (!options.recording.empty()) recorder_ = std::make_unique<Recorder>(options);
    }

    void add(const Objects& objects, std::span<ObjectId> ids, std::span<const Traits> traits);
    void move(std::span<const ObjectId> ids, const Boxes& boxes, bool swept);
    void remove(std::span<const ObjectId> ids);
    void set_traits(std::span<const ObjectId> ids, std::span<const Traits> traits);
    const StepResult& step(const std::stop_token& stop);
    const PairList& pairs() { return history_.list(); }
    const PairList& persisting() {
        subtract(history_.list(), changes_.began, persisting_);
        return persisting_;
    }
    const ObjectTable& table() const { return table_; }
    SceneQueries& queries() { return queries_; }
    /// For queries about the objects as they are now.
    SceneQueries::Scene view(std::uint32_t groups);

private:
    /// An object that is swept until the next step, and where it is then.
    struct Swept {
        ObjectId id;
        Box3d place;
    };

    void check_boxes(const Boxes& boxes, std::size_t expected) const;
    void check_ids(std::span<const ObjectId> ids) const;
    void check_paddings(std::span<const double> paddings, std::size_t objects) const;
    void check_removal(std::span<const ObjectId> ids);
    template <typename Real>
    void move_to(std::span<const ObjectId> ids, std::span<const Box<Real>> boxes);
    template <typename Real>
    void sweep_to(std::span<const ObjectId> ids, std::span<const Box<Real>> boxes);
    void drop_swept(std::uint32_t index);
    void settle_swept();
    void find_all(const std::stop_token& stop);
    void build(const SceneSource& source, const std::stop_token& stop);
    void note_change() { fresh_ = built_ = false; }
    void find_changes(const std::stop_token& stop);
    void finish_step();

    double margin_;
    bool float64_;
    ObjectTable table_;
    ChangeLog log_;
    std::vector<std::uint32_t> removed_;  // since the last step
    std::vector<ObjectId> sorted_;        // of a call
    std::vector<Swept> swept_;
    std::vector<std::uint32_t> swept_at_;  // of an index in swept_, or none; empty before the first
    std::uint64_t moved_ = 0;              // objects, or calls for them, since the last step, beside those added

    Team team_;
    ChangeSearch search_;
    SceneQueries queries_;
    LinearOctree linear_;
    MutableOctree octree_;
    EntryRounding rounding_;
    bool planted_ = false;  // octree_ holds the objects as they were at the last step
    bool fresh_ = false;    // octree_ holds them as they are now
    bool built_ = false;    // linear_ does
    double full_seconds_ = 0;
    double seconds_a_change_ = 0;

    PairHistory history_;
    PairChanges changes_;
    PairList persisting_;
    StepResult result_;
    std::unique_ptr<Recorder> recorder_;  // null: none. Told of each call between the checks and the first change
};

void Scene::State::check_boxes(const Boxes& boxes, std::size_t expected) const {
    if (size_of(boxes) != expected) {
        throw Error(ErrorCode::bad_input,
                    std::to_string(size_of(boxes)) + " boxes for " + std::to_string(expected) + " ids");
    }
    if (std::holds_alternative<std::span<const Box3d>>(boxes) != float64_) {
        throw Error(ErrorCode::bad_input, std::string("boxes are float") + (float64_ ? "32" : "64") +
                                              ", the scene's float" + (float64_ ? "64" : "32"));
    }
    const auto check = [](const auto& span) {
        const auto wrong = std::find_if_not(span.begin(), span.end(), [](const auto& box) { return is_box(box); });
        if (wrong != span.end()) throw fault(std::size_t(wrong - span.begin()), "not a finite box with min <= max");
    };
    std::visit(check, boxes);
}

void Scene::State::check_ids(std::span<const ObjectId> ids) const {
    for (std::size_t i = 0; i < ids.size(); ++i) {
        if (i + ahead < ids.size()) table_.prefetch_slot(ids[i + ahead].index);
        if (table_.contains(ids[i])) continue;
        throw fault(i, "id " + std::to_string(ids[i].index) + "." + std::to_string(ids[i].generation) +
                           " is of no object of the scene");
    }
}

void Scene::State::check_paddings(std::span<const double> paddings, std::size_t objects) const {
    if (!paddings.empty() && paddings.size() != objects) {
        throw Error(ErrorCode::bad_input,
                    std::to_string(paddings.size()) + " paddings for " + std::to_string(objects) + " objects");
    }
    for (std::size_t i = 0; i < paddings.size(); ++i) {
        if (!is_padding(paddings[i])) throw fault(i, "padding is not a finite number >= 0");
    }
}

void Scene::State::add(const Objects& objects, std::span<ObjectId> ids, std::span<const Traits> traits) {
    check_boxes(objects.boxes, ids.size());
    check_paddings(objects.padding, ids.size());
    if (traits.size() > 1 && traits.size() != ids.size()) {
        throw Error(ErrorCode::bad_input,
                    std::to_string(traits.size()) + " traits for " + std::to_string(ids.size()) + " objects");
    }
    if (table_.indices() + ids.size() >= ObjectTable::none) throw Error(ErrorCode::resource_limit, "too many objects");
    note_change();
    table_.reserve(ids.size());
    if (recorder_) recorder_->add(objects, traits);
    for (std::size_t i = 0; i < ids.size(); ++i) {
        const double padding = objects.padding.empty() ? 0 : objects.padding[i];
        ids[i] = table_.create(box_at(objects.boxes, i), padding, traits_at(traits, i));
        log_.note(table_, ids[i].index, false);
    }
}

void Scene::State::move(std::span<const ObjectId> ids, const Boxes& boxes, bool swept) {
    check_boxes(boxes, ids.size());
    check_ids(ids);
    if (recorder_) recorder_->move(swept ? RecordKind::sweep : RecordKind::move, ids, boxes);
    note_change();
    std::visit([&](auto span) { swept ? sweep_to(ids, span) : move_to(ids, span); }, boxes);
}

template <typename Real>
void Scene::State::move_to(std::span<const ObjectId> ids, std::span<const Box<Real>> boxes) {
    const bool any_swept = !swept_.empty();
    log_.expect(table_, ids.size());
    for (std::size_t i = 0; i < ids.size(); ++i) {
        const std::uint32_t index = ids[i].index;
        if (!log_.overflowed()) {
            if (i + ahead < ids.size()) table_.prefetch(ids[i + ahead].index);
            log_.note(table_, index, true);
        }
        if (any_swept) drop_swept(index);
        table_.set_box(index, boxes[i]);
    }
    moved_ += ids.size();
}

template <typename Real>
void Scene::State::sweep_to(std::span<const ObjectId> ids, std::span<const Box<Real>> boxes) {
    if (swept_at_.size() < table_.indices()) swept_at_.resize(std::size_t(table_.indices()), ObjectTable::none);
    for (std::size_t i = 0; i < ids.size(); ++i) {
        const std::uint32_t index = ids[i].index;
        log_.note(table_, index, true);
        drop_swept(index);
        swept_at_[index] = std::uint32_t(swept_.size());
        swept_.push_back({ids[i], wide(boxes[i])});
        table_.set_box(index, joined(table_.box(index), wide(boxes[i])));
    }
    moved_ += ids.size();
}

void Scene::State::drop_swept(std::uint32_t index) {
    if (index >= swept_at_.size() || swept_at_[index] == ObjectTable::none) return;
    swept_[swept_at_[index]].id = {};
    swept_at_[index] = ObjectTable::none;
}

void Scene::State::check_removal(std::span<const ObjectId> ids) {
    check_ids(ids);
    sorted_.assign(ids.begin(), ids.end());
    std::sort(sorted_.begin(), sorted_.end());
    const auto twice = std::adjacent_find(sorted_.begin(), sorted_.end());
    if (twice != sorted_.end()) {
        throw Error(ErrorCode::bad_input, "id " + std::to_string(twice->index) + "." +
                                              std::to_string(twice->generation) + " is to be removed twice");
    }
}

void Scene::State::remove(std::span<const ObjectId> ids) {
    check_removal(ids);
    if (recorder_) recorder_->remove(ids);
    note_change();
    for (const ObjectId& id : ids) {
        log_.note(table_, id.index, true);
        drop_swept(id.index);
        table_.kill(id.index);
        removed_.push_back(id.index);
        ++moved_;
    }
}

void Scene::State::set_traits(std::span<const ObjectId> ids, std::span<const Traits> traits) {
    if (traits.size() != 1 && traits.size() != ids.size()) {
        throw Error(ErrorCode::bad_input,
                    std::to_string(traits.size()) + " traits for " + std::to_string(ids.size()) + " ids");
    }
    check_ids(ids);
    if (recorder_) recorder_->set_traits(ids, traits);
    note_change();
    for (std::size_t i = 0; i < ids.size(); ++i) {
        log_.note(table_, ids[i].index, true);
        table_.set_traits(ids[i].index, traits_at(traits, i));
        ++moved_;
    }
}

const StepResult& Scene::State::step(const std::stop_token& stop) {
    if (recorder_) recorder_->begin_step();
    const auto begin = std::chrono::steady_clock::now();
    const double changed = double(log_.formers().size());
    const double expected = changed * seconds_a_change_;
    const std::uint64_t before = history_.size();
    const bool unlike = rounding_.exact && table_.any_padding();  // boxes in the octree have not been widened
    const bool full = !planted_ || unlike || log_.overflowed() || expected > worth_it * full_seconds_;
    try {
        full ? find_all(stop) : find_changes(stop);
    } catch (const std::bad_alloc&) {
        throw Error(ErrorCode::resource_limit, "out of memory");
    }
    finish_step();
    result_ = {changes_.began, changes_.ended, before - changes_.ended.size(), full, seconds_since(begin)};
    if (recorder_) recorder_->end_step(result_);
    return result_;
}

void Scene::State::find_all(const std::stop_token& stop) {
    const auto begin = std::chrono::steady_clock::now();
    planted_ = fresh_ = false;
    const SceneSource source(table_, margin_);
    build(source, stop);
    PairList::Storage& fresh = history_.fresh().storage();
    fresh.reset();
    AscendingExecutor ascending(team_, fresh, {{0, table_.indices()}, table_.indices()});
    scan(linear_, {source, stop}, ascending, {});
    ascending.append_sorted(stop);
    full_seconds_ = seconds_since(begin);
    const double guess = guessed_cost * full_seconds_ / double(std::max<std::uint64_t>(1, table_.size()));
    // What was learned fades, so that it is tried again.
    seconds_a_change_ = seconds_a_change_ > guess ? 0.95 * seconds_a_change_ : guess;
    if (double(moved_) <= few_moved * double(table_.size())) {
        octree_.build(linear_, stop);
        linear_ = {};
        planted_ = true;
        built_ = false;
    }
    history_.take_over(changes_);  // the last step: one that fails before has changed nothing
}

void Scene::State::build(const SceneSource& source, const std::stop_token& stop) {
    TeamExecutor executor(team_);
    built_ = false;
    linear_.build(source, executor, stop);
    rounding_ = {source.boxes().exact(), source.boxes().rounding()};
    built_ = true;
}

SceneQueries::Scene Scene::State::view(std::uint32_t groups) {
    const bool follows = planted_ && !log_.overflowed();
    if (!follows && !fresh_) {
        planted_ = false;
        if (!built_) build(SceneSource(table_, margin_), {});
        octree_.build(linear_, {});
        fresh_ = true;
    }
    return {table_, octree_, rounding_.rounding, follows ? &log_ : nullptr, groups};
}

void Scene::State::find_changes(const std::stop_token& stop) {
    const auto begin = std::chrono::steady_clock::now();
    try {
        search_.run({table_, log_, rounding_, margin_}, octree_, changes_, stop);
    } catch (const Error& error) {
        if (error.code() != ErrorCode::cancelled) planted_ = false;
        throw;
    } catch (...) {
        planted_ = false;
        throw;
    }
    history_.apply(changes_);
    const std::size_t changed = log_.formers().size();
    constexpr std::size_t enough = 64;  // to tell what one costs
    if (changed >= enough) seconds_a_change_ += (seconds_since(begin) / double(changed) - seconds_a_change_) / 4;
}

void Scene::State::finish_step() {
    log_.clear(table_);
    for (const std::uint32_t index : removed_) table_.release(index);
    removed_.clear();
    moved_ = 0;
    settle_swept();
}

/// What was swept is where it came to, from now on.
void Scene::State::settle_swept() {
    for (const Swept& swept : swept_) {
        if (!table_.contains(swept.id)) continue;
        note_change();
        swept_at_[swept.id.index] = ObjectTable::none;
        log_.note(table_, swept.id.index, true);
        table_.set_box(swept.id.index, swept.place);
        ++moved_;
    }
    swept_.clear();
}

Scene::Scene(const SceneOptions& options) : state_(std::make_unique<State>(options)) {}
Scene::Scene(Scene&&) noexcept = default;
Scene& Scene::operator=(Scene&&) noexcept = default;
Scene::~Scene() = default;

void Scene::add(const Objects& objects, std::span<ObjectId> ids, std::span<const Traits> traits) {
    state_->add(objects, ids, traits);
}

void Scene::move(std::span<const ObjectId> ids, const Boxes& boxes) { state_->move(ids, boxes, false); }
void Scene::sweep(std::span<const ObjectId> ids, const Boxes& boxes) { state_->move(ids, boxes, true); }
void Scene::remove(std::span<const ObjectId> ids) { state_->remove(ids); }

void Scene::set_traits(std::span<const ObjectId> ids, std::span<const Traits> traits) {
    state_->set_traits(ids, traits);
}

const StepResult& Scene::step(std::stop_token stop) { return state_->step(stop); }
const PairList& Scene::pairs() { return state_->pairs(); }
const PairList& Scene::persisting() { return state_->persisting(); }

void Scene::overlaps(std::span<const Box3d> boxes, Answers<std::uint32_t>& answers, std::uint32_t groups) {
    check_queries(boxes, [](const Box3d& box) { return is_box(box); });
    state_->queries().overlaps(state_->view(groups), boxes, answers);
}

void Scene::overlaps(std::span<const Sphere> spheres, Answers<std::uint32_t>& answers, std::uint32_t groups) {
    check_queries(spheres, is_sphere);
    state_->queries().overlaps(state_->view(groups), spheres, answers);
}

void Scene::first_hits(std::span<const Ray> rays, Answers<RayHit>& answers, std::uint32_t groups) {
    check_queries(rays, is_ray);
    state_->queries().first_hits(state_->view(groups), rays, answers);
}

void Scene::all_hits(std::span<const Ray> rays, Answers<RayHit>& answers, std::uint32_t groups) {
    check_queries(rays, is_ray);
    state_->queries().all_hits(state_->view(groups), rays, answers);
}

void Scene::nearest(std::span<const Box3d> places, std::size_t count, Answers<Neighbor>& answers,
                    std::uint32_t groups) {
    check_queries(places, [](const Box3d& box) { return is_box(box); });
    state_->queries().nearest(state_->view(groups), places, count, answers);
}

std::vector<std::uint32_t> Scene::overlaps(const Box3d& box, std::uint32_t groups) {
    Answers<std::uint32_t> answers;
    overlaps(std::span(&box, 1), answers, groups);
    return std::move(answers.all);
}

std::vector<std::uint32_t> Scene::overlaps(const Sphere& sphere, std::uint32_t groups) {
    Answers<std::uint32_t> answers;
    overlaps(std::span(&sphere, 1), answers, groups);
    return std::move(answers.all);
}

std::optional<RayHit> Scene::first_hit(const Ray& ray, std::uint32_t groups) {
    Answers<RayHit> answers;
    first_hits(std::span(&ray, 1), answers, groups);
    return answers.all.empty() ? std::nullopt : std::optional(answers.all.front());
}

std::vector<RayHit> Scene::all_hits(const Ray& ray, std::uint32_t groups) {
    Answers<RayHit> answers;
    all_hits(std::span(&ray, 1), answers, groups);
    return std::move(answers.all);
}

std::vector<Neighbor> Scene::nearest(const Box3d& place, std::size_t count, std::uint32_t groups) {
    Answers<Neighbor> answers;
    nearest(std::span(&place, 1), count, answers, groups);
    return std::move(answers.all);
}

std::uint64_t Scene::size() const { return state_->table().size(); }
std::uint64_t Scene::indices() const { return state_->table().indices(); }
bool Scene::contains(ObjectId id) const { return state_->table().contains(id); }

ObjectId Scene::id(std::uint32_t index) const {
    const ObjectTable& table = state_->table();
    if (index >= table.indices() || !table.alive(index)) {
        throw Error(ErrorCode::bad_input, "no object has the index " + std::to_string(index));
    }
    return table.id(index);
}

}  // namespace octopair
