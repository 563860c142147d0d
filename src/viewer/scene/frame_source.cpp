#include "viewer/scene/frame_source.hpp"

#include <algorithm>
#include <charconv>
#include <chrono>
#include <cmath>
#include <new>
#include <numeric>

#include "octopair/error.hpp"
#include "octopair/version.hpp"
#include "viewer/scene/frame_answers.hpp"
#include "viewer/scene/source.hpp"

namespace octopair::viewer {

namespace {

Json number_or_text(const Fact& fact) {
    if (!fact.text.empty()) return fact.text;
    const bool whole = std::floor(fact.number) == fact.number && std::abs(fact.number) < 1e15;
    return whole ? Json(std::int64_t(fact.number)) : Json(fact.number);
}

/// Maximum number of empty frames at the begin that are skipped to find the first frame with objects.
constexpr std::uint64_t max_empty_frames = 100;

/// Adds facts to an object. "seconds.read" becomes the member "read" of "seconds".
void add_facts(Json& json, const std::vector<Fact>& facts, bool with_seconds) {
    for (const Fact& fact : facts) {
        const std::size_t dot = fact.name.find('.');
        if (dot == std::string::npos) {
            json[fact.name] = number_or_text(fact);
        } else if (with_seconds) {
            json[fact.name.substr(0, dot)][fact.name.substr(dot + 1)] = number_or_text(fact);
        }
    }
}

/// Selects all rows that an exported page has: the worst ones.
RowRequest all_rows() {
    RowRequest request;
    request.sort = RowRequest::Sort::worst;
    request.count = max_rows;
    return request;
}

bool has_contacts(const std::vector<Finding>& findings) {
    return std::any_of(findings.begin(), findings.end(),
                       [](const Finding& finding) { return !finding.contacts.empty(); });
}

}  // namespace

FrameSource::FrameSource(SceneContents contents, FrameFinder& finder, std::size_t most_shown)
    : contents_(std::move(contents)), finder_(finder), most_shown_(most_shown) {}

void FrameSource::load(const ProgressSink& progress) {
    const std::lock_guard lock(frames_mutex_);
    auto first = std::make_shared<Frame>();
    first->data = finder_.find(0, progress);
    first->began = first->data.pairs;
    shown_ = ShownObjects(first->data, contents_.objects, most_shown_);
    // A first frame may be empty, so the origin is that of the first frame with objects.
    std::optional<Box3d> bounds = bounds_of(first->data);
    for (std::uint64_t number = 1; !bounds && number < std::min(frames(), max_empty_frames); ++number) {
        bounds = bounds_of(finder_.find(number, {}));
    }
    bounds_ = bounds.value_or(no_bounds());
    has_bounds_ = bounds.has_value();
    origin_ = centre_of(bounds_);
    first_pairs_ = {first->data.pair_count, first->data.more_pairs};
    first_facts_ = first->data.facts;
    contents_.contacts |= has_contacts(first->data.findings);
    has_classes_ = contents_.contacts || !first->data.findings.empty();
    if (shown_.size() < contents_.objects) {
        contents_.notices.push_back(grouped_number(contents_.objects - shown_.size()) + " of " +
                                    grouped_number(contents_.objects) + " boxes are drawn only where you zoom in.");
    }
    if (first->data.more_pairs) {
        contents_.notices.push_back("Only the first " + grouped_number(first_pairs_.pairs) +
                                    " pairs are shown; more exist.");
    }
    if (!contents_.moving) first->began.clear();
    kept_.push_back(std::move(first));
    loading_ = false;
}

FrameSource::FramePointer FrameSource::find(std::uint64_t number, const FramePointer& before) {
    auto frame = std::make_shared<Frame>();
    frame->number = number;
    frame->data = finder_.find(number, {});
    if (contents_.moving) {
        const std::vector<Pair> none;
        const std::vector<Pair>&now = frame->data.pairs, &then = before != nullptr ? before->data.pairs : none;
        std::set_difference(now.begin(), now.end(), then.begin(), then.end(), std::back_inserter(frame->began));
        std::set_difference(then.begin(), then.end(), now.begin(), now.end(), std::back_inserter(frame->ended));
    }
    return frame;
}

/// Returns a frame. Finds it, and the frame before it, if they are not kept. Requires: frames_mutex_ is locked.
FrameSource::FramePointer FrameSource::frame(std::uint64_t number) {
    const auto kept = [&](std::uint64_t wanted) -> FramePointer {
        const auto found =
            std::find_if(kept_.begin(), kept_.end(), [&](const auto& frame) { return frame->number == wanted; });
        return found == kept_.end() ? nullptr : *found;
    };
    if (FramePointer found = kept(number)) return found;
    FramePointer before;
    if (contents_.moving && number > 0) {
        before = kept(number - 1);
        if (before == nullptr) {
            before = std::make_shared<Frame>();
            before->data = finder_.find(number - 1, {});
        }
    }
    FramePointer found = find(number, before);
    kept_.push_back(found);
    if (kept_.size() > kept_frames) kept_.pop_front();
    return found;
}

FrameSource::FramePointer FrameSource::count_frame(std::uint64_t number, const FramePointer& before) {
    const std::lock_guard lock(frames_mutex_);
    FramePointer now;
    const auto fail = [this](const char* why) {
        const std::lock_guard counts_lock(counts_mutex_);
        counts_.fault = why;
    };
    try {
        now = find(number, before);
    } catch (const std::bad_alloc&) {
        fail("out of memory");
        throw Error(ErrorCode::resource_limit, "out of memory");
    } catch (const std::exception& error) {
        fail(error.what());
        throw;
    }
    const std::lock_guard counts_lock(counts_mutex_);
    if (const auto bounds = bounds_of(now->data)) {
        bounds_ = has_bounds_ ? joined(bounds_, *bounds) : *bounds;
        has_bounds_ = true;
    }
    counts_.pairs.push_back(now->data.pair_count);
    counts_.more_pairs |= now->data.more_pairs;
    counts_.began.push_back(now->began.size());
    counts_.ended.push_back(now->ended.size());
    return now;
}

void FrameSource::count_frames(const std::function<void(std::uint64_t)>& more, const std::stop_token& stop) {
    using Clock = std::chrono::steady_clock;
    auto last_call = Clock::now();
    FramePointer before;
    for (std::uint64_t number = 0; number < frames() && !stop.stop_requested(); ++number) {
        before = count_frame(number, before);
        const bool last = number + 1 == frames();
        if (more && (last || Clock::now() - last_call > std::chrono::milliseconds(200))) {
            last_call = Clock::now();
            more(number + 1);
        }
    }
}

std::uint64_t FrameSource::counted() const {
    const std::lock_guard lock(counts_mutex_);
    return counts_.pairs.size();
}

FrameSource::PairTotal FrameSource::pair_total() const {
    const std::lock_guard lock(counts_mutex_);
    if (counts_.pairs.empty()) return first_pairs_;
    return {std::accumulate(counts_.pairs.begin(), counts_.pairs.end(), std::uint64_t(0)), counts_.more_pairs};
}

const Octants& FrameSource::octants(Frame& frame) {
    if (!frame.octants) frame.octants = octants_of(shown_frame(frame));
    return *frame.octants;
}

ShownFrame FrameSource::shown_frame(const Frame& frame) const {
    return {contents_, contents_.objects, shown_, origin_, frame.data, frame.began, frame.ended};
}

std::optional<Answer> FrameSource::get(const Address& address) {
    const std::vector<std::string_view> parts = address.parts();
    if (parts.size() == 1) return get_scene(parts[0], address);
    if (parts[0] == "shape" && parts.size() == 2) {
        const auto number = whole_number(parts[1]);
        return number ? shape_answer(*number) : std::nullopt;
    }
    const std::size_t dot = parts[1].rfind('.');
    const std::string_view digits = parts[1].substr(0, dot);
    const auto number = whole_number(digits);
    if (!number || *number >= frames()) return std::nullopt;
    const std::lock_guard lock(frames_mutex_);
    const FramePointer found = frame(*number);
    if (parts.size() == 2 && dot != std::string_view::npos) {
        return answer_about(*found, std::string(parts[0]) + std::string(parts[1].substr(dot)), address);
    }
    if (parts.size() != 3) return std::nullopt;
    if (parts[0] == "octants") return octant_answer(*found, parts[2]);
    const auto object = whole_number(parts[2].substr(0, parts[2].rfind('.')));
    if (parts[0] != "object" || !parts[2].ends_with(".json") || !object || *object >= contents_.objects)
        return std::nullopt;
    return object_answer(shown_frame(*found), std::uint32_t(*object), &octants(*found));
}

std::optional<Answer> FrameSource::get_scene(std::string_view what, const Address& address) {
    if (what == "view.json") return view_answer();
    if (what == "shown.u32" && !shown_.in_order()) return binary_answer(shown_.objects());
    if (what == "groups.u32" && !contents_.groups.empty()) return shown_column(contents_.groups);
    if (what == "names.json" && !contents_.names.empty()) return name_column();
    if (what == "details.json" && !contents_.details.columns.empty()) return detail_columns();
    if (what == "gone.json" && !contents_.gone.empty()) return gone_rows(contents_.gone);
    if (what == "geometry.u32" && !contents_.shapes.empty()) return shown_column(contents_.geometry);
    if (what == "shapes.json" && !contents_.shapes.empty()) return shapes_answer();
    if (what == "timeline.json" && contents_.moving) return timeline_answer();
    if (what != "search.json" || export_) return std::nullopt;
    const std::lock_guard lock(frames_mutex_);
    return search_answer(shown_frame(*kept_.back()), address.parameter("q"));
}

std::optional<Answer> FrameSource::answer_about(Frame& frame, std::string_view what, const Address& address) {
    const ShownFrame shown = shown_frame(frame);
    if (what == "frame.json") return frame_answer(frame);
    if (what == "frame.f32") return box_rows(shown);
    if (what == "poses.f32" && !contents_.shapes.empty()) return pose_rows();
    if (what == "partners.u32") return partner_counts(shown);
    if (what == "classes.u8" && has_classes_) return class_rows(shown);
    if (what == "levels.u8") return level_column(frame);
    if (what == "pairs.u32") return pair_rows(frame.data.pairs);
    if (what == "began.u32" && contents_.moving) return pair_rows(frame.began);
    if (what == "ended.u32" && contents_.moving) return pair_rows(frame.ended);
    if (what == "octants.json") return octant_summary(octants(frame));
    if (what == "collisions.json") return collision_rows(shown, export_ ? all_rows() : row_request(address));
    if (what == "near.bin" && !export_) return near_answer(shown, region_of(address));
    return std::nullopt;
}

std::optional<Answer> FrameSource::octant_answer(Frame& frame, std::string_view level) {
    if (!level.ends_with(".bin")) return std::nullopt;
    const auto number = whole_number(level.substr(0, level.size() - 4));
    if (!number || *number > OctalCode::max_level) return std::nullopt;
    return octant_level(octants(frame), unsigned(*number), origin_);
}

Answer FrameSource::view_answer() const {
    const std::lock_guard lock(counts_mutex_);
    Json has = {{"rows", !shown_.in_order()},
                {"boxes", contents_.has_boxes},
                {"names", !contents_.names.empty()},
                {"details", !contents_.details.columns.empty()},
                {"gone", !contents_.gone.empty()},
                {"octants", !export_ || export_->octants},
                {"groups", !contents_.groups.empty()},
                {"shapes", !contents_.shapes.empty()},
                {"contacts", contents_.contacts},
                {"classes", has_classes_},
                {"events", contents_.moving},
                {"search", !export_},
                {"near", !export_ && shown_.size() < contents_.objects}};
    Json summary = {{"pairs", first_pairs_.pairs}};
    add_facts(summary, contents_.facts, !export_);
    add_facts(summary, first_facts_, !export_);
    std::vector<std::string> notices = contents_.notices;
    if (export_) notices.insert(notices.end(), export_->notices.begin(), export_->notices.end());
    Json files = Json::array();
    for (const ShownFile& file : contents_.files) files.push_back({{"name", file.name}, {"first", file.first}});
    Json view = {{"version", OCTOPAIR_VERSION},
                 {"title", contents_.title},
                 {"kind", "scene"},
                 {"objects", contents_.objects},
                 {"shown", shown_.size()},
                 {"frames", export_ ? export_->frames : frames()},
                 {"origin", json_of(origin_)},
                 {"bounds", json_of(bounds_)},
                 {"up", contents_.up},
                 {"unit", contents_.unit},
                 {"margin", contents_.margin},
                 {"files", std::move(files)},
                 {"has", std::move(has)},
                 {"notices", std::move(notices)},
                 {"summary", std::move(summary)}};
    if (contents_.second_set) view["second_set"] = *contents_.second_set;
    return json_answer(view);
}

Answer FrameSource::frame_answer(const Frame& frame) const {
    const std::vector<std::uint8_t>& exists = frame.data.exists;
    Json json = {{"frame", frame.number},
                 {"objects", exists.empty() ? contents_.objects
                                            : exists.size() - std::size_t(std::count(exists.begin(), exists.end(), 0))},
                 {"pairs", frame.data.pair_count},
                 {"pairs_listed", std::min(frame.data.pairs.size(), max_listed_pairs)},
                 {"began", frame.began.size()},
                 {"ended", frame.ended.size()}};
    if (Json counts = class_counts(frame.data); !counts.empty()) json["classes"] = std::move(counts);
    add_facts(json, frame.data.facts, !export_);
    return json_answer(json);
}

/// Returns the number of pairs of each class that the frame has.
Json FrameSource::class_counts(const FrameData& data) const {
    std::vector<std::uint64_t> counts = data.class_counts;
    if (counts.empty()) {
        counts.resize(collision_classes);
        for (const Finding& finding : data.findings) ++counts[std::size_t(finding.collision_class)];
    }
    Json json = Json::object();
    for (std::size_t i = 1; i < counts.size(); ++i) {
        if (counts[i] > 0) json[std::string(class_word(CollisionClass(i)))] = counts[i];
    }
    return json;
}

Answer FrameSource::timeline_answer() const {
    const std::lock_guard lock(counts_mutex_);
    const std::uint64_t all = export_ ? export_->frames : frames();
    const auto first = [&](const std::vector<std::uint64_t>& counts) {
        return std::vector<std::uint64_t>(counts.begin(),
                                          counts.begin() + std::ptrdiff_t(std::min<std::uint64_t>(all, counts.size())));
    };
    Json json = {{"frames", all},
                 {"done", std::min<std::uint64_t>(all, counts_.pairs.size())},
                 {"pairs", first(counts_.pairs)},
                 {"began", first(counts_.began)},
                 {"ended", first(counts_.ended)}};
    if (!counts_.fault.empty()) json["failed"] = counts_.fault;
    return json_answer(json);
}

Answer FrameSource::shapes_answer() const {
    Json list = Json::array();
    for (const ShownShape& shape : contents_.shapes) {
        list.push_back(
            {{"kind", shape.kind}, {"vertices", shape.vertices.size()}, {"triangles", shape.triangles.size()}});
    }
    return json_answer({{"shapes", std::move(list)}});
}

std::optional<Answer> FrameSource::shape_answer(std::uint64_t number) const {
    if (number >= contents_.shapes.size()) return std::nullopt;
    const ShownShape& shape = contents_.shapes[std::size_t(number)];
    Answer answer;
    append_array(answer.body, std::span<const std::array<float, 3>>(shape.vertices));
    append_array(answer.body, std::span<const std::array<std::uint32_t, 3>>(shape.triangles));
    return answer;
}

Answer FrameSource::pose_rows() const {
    std::vector<float> rows;
    rows.reserve(12 * shown_.size());
    for (const std::uint32_t object : shown_.objects()) {
        const Pose& pose = contents_.poses[object];
        const std::uint32_t shape = contents_.geometry[object];
        const Point3d centre = shape < contents_.shapes.size() ? contents_.shapes[shape].centre : Point3d{};
        for (std::size_t column = 0; column < 3; ++column) {
            for (std::size_t row = 0; row < 3; ++row) rows.push_back(float(pose.rows[row][column]));
        }
        for (std::size_t row = 0; row < 3; ++row) {
            const auto& numbers = pose.rows[row];
            const double moved = numbers[0] * centre[0] + numbers[1] * centre[1] + numbers[2] * centre[2];
            rows.push_back(float(moved + numbers[3] - origin_[row]));
        }
    }
    return binary_answer(std::span<const float>(rows));
}

template <typename T>
Answer FrameSource::shown_column(const std::vector<T>& of_objects) const {
    std::vector<T> column;
    column.reserve(shown_.size());
    for (const std::uint32_t object : shown_.objects()) column.push_back(of_objects[object]);
    return binary_answer(std::span<const T>(column));
}

Answer FrameSource::name_column() const {
    Json names = Json::array();
    for (const std::uint32_t object : shown_.objects()) names.push_back(contents_.names[object]);
    return json_answer(names);
}

Answer FrameSource::detail_columns() const {
    Json json = {{"words", contents_.details.words}};
    for (const ObjectTexts::Column& column : contents_.details.columns) {
        Json words = Json::array();
        for (const std::uint32_t object : shown_.objects()) words.push_back(column.words[object]);
        json[column.name] = std::move(words);
    }
    return json_answer(json);
}

Answer FrameSource::level_column(Frame& frame) {
    const std::vector<std::uint8_t> levels = levels_of(frame.data, octants(frame));
    return shown_column(levels);
}

std::vector<std::string> FrameSource::greeting(const std::string& path) {
    if (!path.empty()) return {};
    return {loading_ ? progress_message("finding pairs", progress_) : ready_message()};
}

void FrameSource::prepare_export(Export how) { export_ = std::move(how); }

std::vector<std::string> FrameSource::addresses() const {
    std::vector<std::string> all = {"view.json"};
    if (!shown_.in_order()) all.push_back("shown.u32");
    if (!contents_.groups.empty()) all.push_back("groups.u32");
    if (!contents_.names.empty()) all.push_back("names.json");
    if (!contents_.details.columns.empty()) all.push_back("details.json");
    if (!contents_.gone.empty()) all.push_back("gone.json");
    if (contents_.moving) all.push_back("timeline.json");
    if (contents_.shapes.empty()) return all;
    all.insert(all.end(), {"geometry.u32", "shapes.json", "poses/0.f32"});
    for (std::size_t i = 0; i < contents_.shapes.size(); ++i) all.push_back("shape/" + std::to_string(i));
    return all;
}

std::vector<std::string> FrameSource::addresses_of(std::uint64_t number) {
    const std::string f = std::to_string(number);
    std::vector<std::string> all;
    for (const char* const what :
         {"frame/#.json", "frame/#.f32", "partners/#.u32", "pairs/#.u32", "collisions/#.json"}) {
        all.push_back(what);
    }
    if (contents_.moving) all.insert(all.end(), {"began/#.u32", "ended/#.u32"});
    if (has_classes_) all.push_back("classes/#.u8");
    if (!export_ || export_->octants) {
        all.insert(all.end(), {"levels/#.u8", "octants/#.json"});
        const std::lock_guard lock(frames_mutex_);
        unsigned deepest = 0;
        for (const OctantSummary& octant : octants(*frame(number)).all())
            deepest = std::max(deepest, octant.code.level());
        for (unsigned level = 0; level <= deepest; ++level)
            all.push_back("octants/#/" + std::to_string(level) + ".bin");
    }
    for (std::string& address : all) address.replace(address.find('#'), 1, f);
    return all;
}

}  // namespace octopair::viewer
