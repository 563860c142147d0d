#include "viewer/scene/frame_answers.hpp"

#include <algorithm>
#include <bit>
#include <charconv>
#include <cmath>

#include "octopair/error.hpp"

namespace octopair::viewer {

Answer json_answer(const Json& json) {
    return {AnswerKind::json, json.dump(-1, ' ', false, Json::error_handler_t::replace)};
}

Json json_of(const Point3d& point) { return Json::array({point[0], point[1], point[2]}); }

Json json_of(const Box3d& box) {
    return {{"min", Json::array({box.min[0], box.min[1], box.min[2]})},
            {"max", Json::array({box.max[0], box.max[1], box.max[2]})}};
}

std::string grouped_number(std::uint64_t number) {
    std::string text = std::to_string(number);
    for (std::size_t end = text.size(); end > 3;) text.insert(end -= 3, ",");
    return text;
}

Answer box_rows(const ShownFrame& frame) {
    std::vector<RelativeBox> rows;
    rows.reserve(frame.shown.size());
    for (const std::uint32_t object : frame.shown.objects()) {
        rows.push_back(frame.data.has(object) ? relative(box_of(frame.data, object), frame.origin) : no_box());
    }
    return binary_answer(std::span<const RelativeBox>(rows));
}

std::vector<std::uint32_t> pair_counts(const FrameData& data, std::uint64_t objects) {
    std::vector<std::uint32_t> counts(std::size_t(objects), 0);
    for (const auto [a, b] : data.pairs) {
        ++counts[a];
        ++counts[b];
    }
    return counts;
}

Answer partner_counts(const ShownFrame& frame) {
    const std::vector<std::uint32_t> counts = pair_counts(frame.data, frame.objects);
    std::vector<std::uint32_t> rows;
    rows.reserve(frame.shown.size());
    for (const std::uint32_t object : frame.shown.objects()) rows.push_back(counts[object]);
    return binary_answer(std::span<const std::uint32_t>(rows));
}

Answer pair_rows(std::span<const Pair> pairs, std::size_t most) {
    return binary_answer(pairs.first(std::min(pairs.size(), most)));
}

// ---- Octants -------------------------------------------------------------------------------------------------------

Octants octants_of(const ShownFrame& frame, unsigned threads) {
    const OctantOptions options{frame.contents.margin, threads};
    const FrameData& data = frame.data;
    if (data.exists.empty()) return list_octants({data.boxes, data.padding}, options);
    // Objects that do not exist have no boxes, so the octree is that of the others.
    std::vector<Box3d> boxes;
    for (std::size_t i = 0; i < data.exists.size(); ++i) {
        if (data.has(i)) boxes.push_back(box_of(data, i));
    }
    return list_octants({std::span<const Box3d>(boxes)}, options);
}

std::vector<std::uint8_t> levels_of(const FrameData& data, const Octants& octants) {
    std::vector<std::uint8_t> levels = octants.levels();
    if (data.exists.empty()) return levels;
    std::vector<std::uint8_t> of_all(data.exists.size(), 0);
    std::size_t next = 0;
    for (std::size_t i = 0; i < of_all.size(); ++i) {
        if (data.has(i)) of_all[i] = levels[next++];
    }
    return of_all;
}

/// Returns the code of the octant in which an object's box begins.
static OctalCode home_code(const FrameData& data, std::uint32_t object, const Octants& octants) {
    const auto before = data.exists.begin() + std::ptrdiff_t(data.exists.empty() ? 0 : object);
    const std::size_t position = data.exists.empty() ? object : std::size_t(std::count(data.exists.begin(), before, 1));
    return octants.all()[octants.home_octants()[position]].code;
}

namespace {

/// Returns the part of an octant in which objects are looked up; nothing for an octant beyond.
std::optional<Box3d> used_part(const OctantSummary& octant, const Box3d& space) {
    if (!overlap(octant.bounds, space)) return std::nullopt;
    Box3d part = octant.bounds;
    for (int i = 0; i < 3; ++i) {
        part.min[i] = std::max(part.min[i], space.min[i]);
        part.max[i] = std::min(part.max[i], space.max[i]);
    }
    return part;
}

}  // namespace

Answer octant_summary(const Octants& octants) {
    struct Level {
        std::uint64_t octants = 0, leaves = 0, listed = 0;
    };
    std::vector<Level> levels;
    std::uint64_t entries = 0;
    const Box3d space = octants.space();
    for (const OctantSummary& octant : octants.all()) {
        if (!used_part(octant, space)) continue;
        levels.resize(std::max<std::size_t>(levels.size(), octant.code.level() + 1));
        Level& level = levels[octant.code.level()];
        ++level.octants;
        level.leaves += octant.leaf ? 1 : 0;
        level.listed = std::min<std::uint64_t>(level.octants, max_listed_octants);
        entries += octant.entries;
    }
    Json list = Json::array();
    for (const Level& level : levels) {
        list.push_back({{"octants", level.octants}, {"leaves", level.leaves}, {"listed", level.listed}});
    }
    return json_answer({{"entries", entries}, {"levels", list}});
}

Answer octant_level(const Octants& octants, unsigned level, const Point3d& origin) {
    struct Row {
        RelativeBox bounds;
        std::uint32_t entries, homes, flags, key_high, key_low;
    };
    static_assert(sizeof(Row) == 44);
    const auto at_most_32_bits = [](std::uint64_t count) {
        return std::uint32_t(std::min<std::uint64_t>(count, 0xFFFFFFFF));
    };
    const Box3d space = octants.space();
    std::vector<Row> rows;
    for (const OctantSummary& octant : octants.all()) {
        if (octant.code.level() != level || rows.size() == max_listed_octants) continue;
        const auto part = used_part(octant, space);
        if (!part) continue;
        const std::uint64_t key = octant.code.key();
        rows.push_back({relative(*part, origin), at_most_32_bits(octant.entries), at_most_32_bits(octant.homes),
                        octant.leaf ? 1u : 0u, std::uint32_t(key >> 32), std::uint32_t(key)});
    }
    return binary_answer(std::span<const Row>(rows));
}

// ---- Table of collisions -------------------------------------------------------------------------------------------

namespace {

std::string_view name_of(const SceneContents& contents, std::uint32_t object) {
    return object < contents.names.size() ? std::string_view(contents.names[object]) : std::string_view();
}

std::string lower_case(std::string_view text) {
    std::string out(text);
    for (char& c : out) c = c >= 'A' && c <= 'Z' ? char(c | 0x20) : c;
    return out;
}

/// Returns whether the name of an object has `text` (in lower case), or its index is `text`.
bool matches(const SceneContents& contents, std::uint32_t object, std::string_view text) {
    return std::to_string(object) == text || lower_case(name_of(contents, object)).find(text) != std::string::npos;
}

constexpr std::string_view class_words[] = {"unknown",     "clearance", "collision", "touching",
                                            "penetrating", "contained", "duplicate"};

Json contact_json(const Contact& contact) {
    return {{"point", json_of(contact.point)}, {"normal", json_of(contact.normal)}, {"depth", contact.depth}};
}

void add_finding(Json& row, const Finding& finding) {
    row["class"] = class_words[std::size_t(finding.collision_class)];
    if (finding.collision_class > CollisionClass::clearance) {
        row["depth"] = finding.depth;
    } else {
        row["distance"] = finding.distance;
    }
    if (finding.contacts.empty()) return;
    Json contacts = Json::array();
    constexpr std::size_t most = 16;
    for (std::size_t i = 0; i < std::min(most, finding.contacts.size()); ++i) {
        contacts.push_back(contact_json(finding.contacts[i]));
    }
    row["contacts"] = std::move(contacts);
}

class Table {
public:
    explicit Table(const ShownFrame& frame) : frame_(frame) {}

    Answer rows(const RowRequest& request) {
        std::vector<std::uint32_t> kept = select(request);
        sort(kept, request.sort);
        const std::size_t from = std::size_t(std::min<std::uint64_t>(request.from, kept.size()));
        const std::size_t count = std::size_t(std::min<std::uint64_t>(request.count, kept.size() - from));
        Json list = Json::array();
        for (std::size_t i = from; i < from + count; ++i) list.push_back(row(kept[i]));
        return json_answer({{"total", kept.size()}, {"rows", list}});
    }

private:
    std::vector<std::uint32_t> select(const RowRequest& request) const {
        const std::string text = lower_case(request.text);
        std::vector<std::uint32_t> kept;
        for (std::uint32_t i = 0; i < frame_.data.pairs.size(); ++i) {
            const auto [a, b] = frame_.data.pairs[i];
            if (request.object && a != *request.object && b != *request.object) continue;
            if (!text.empty() && !matches(frame_.contents, a, text) && !matches(frame_.contents, b, text)) continue;
            kept.push_back(i);
        }
        return kept;
    }

    void sort(std::vector<std::uint32_t>& rows, RowRequest::Sort order) const {
        const auto& findings = frame_.data.findings;
        if (order == RowRequest::Sort::depth && !findings.empty()) {
            std::stable_sort(rows.begin(), rows.end(),
                             [&](auto a, auto b) { return findings[a].depth > findings[b].depth; });
        } else if (order == RowRequest::Sort::began) {
            std::stable_partition(rows.begin(), rows.end(), [&](auto i) { return has_begun(frame_.data.pairs[i]); });
        }
    }

    bool has_begun(Pair pair) const { return std::binary_search(frame_.began.begin(), frame_.began.end(), pair); }

    Json row(std::uint32_t i) const {
        const Pair pair = frame_.data.pairs[i];
        Json row = {{"a", pair.a}, {"b", pair.b}};
        if (!frame_.contents.names.empty()) {
            row["name_a"] = name_of(frame_.contents, pair.a);
            row["name_b"] = name_of(frame_.contents, pair.b);
        }
        if (has_begun(pair)) row["change"] = "began";
        if (!frame_.data.findings.empty()) add_finding(row, frame_.data.findings[i]);
        return row;
    }

    ShownFrame frame_;
};

std::uint64_t count_of(const Address& address, const std::string& name, std::uint64_t otherwise) {
    const std::string_view text = address.parameter(name);
    if (text.empty()) return otherwise;
    const auto value = whole_number(text);
    if (!value) throw Error(ErrorCode::bad_input, name + ": not a whole number");
    return *value;
}

}  // namespace

RowRequest row_request(const Address& address) {
    RowRequest request;
    request.from = count_of(address, "from", 0);
    request.count = std::min<std::uint64_t>(count_of(address, "count", request.count), max_rows);
    if (!address.parameter("object").empty()) {
        request.object = std::uint32_t(std::min<std::uint64_t>(count_of(address, "object", 0), 0xFFFFFFFF));
    }
    request.text = address.parameter("q");
    const std::string_view sort = address.parameter("sort");
    if (sort == "depth") {
        request.sort = RowRequest::Sort::depth;
    } else if (sort == "began") {
        request.sort = RowRequest::Sort::began;
    } else if (!sort.empty() && sort != "pair") {
        throw Error(ErrorCode::bad_input, "sort: pair, depth or began");
    }
    return request;
}

Answer collision_rows(const ShownFrame& frame, const RowRequest& request) { return Table(frame).rows(request); }

// ---- Objects -------------------------------------------------------------------------------------------------------

std::optional<Answer> object_answer(const ShownFrame& frame, std::uint32_t object, const Octants* octants) {
    const SceneContents& contents = frame.contents;
    if (object >= frame.objects) return std::nullopt;
    Json json = {{"index", object}};
    if (!contents.names.empty()) json["name"] = name_of(contents, object);
    if (contents.details) {
        Json details = Json::object();
        for (const auto& [what, text] : contents.details(object)) details[what] = text;
        if (!details.empty()) json["details"] = std::move(details);
    }
    const std::uint32_t row = frame.shown.row_of(object);
    json["row"] = row == ShownObjects::none ? -1 : std::int64_t(row);
    if (!contents.groups.empty()) json["groups"] = contents.groups[object];
    if (frame.data.has(object)) {
        json["box"] = json_of(box_of(frame.data, object));
        if (octants != nullptr) {
            const OctalCode code = home_code(frame.data, object, *octants);
            json["code"] = code.text();
            json["level"] = code.level();
        }
    }
    std::vector<std::uint32_t> partners;
    std::uint64_t count = 0;
    for (const auto [a, b] : frame.data.pairs) {
        if (a != object && b != object) continue;
        ++count;
        if (partners.size() < max_partners) partners.push_back(a == object ? b : a);
    }
    std::sort(partners.begin(), partners.end());
    json["partner_count"] = count;
    json["partners"] = std::move(partners);
    return json_answer(json);
}

Answer search_answer(const ShownFrame& frame, std::string_view text) {
    const SceneContents& contents = frame.contents;
    const std::string wanted = lower_case(text);
    std::vector<std::uint32_t> found;
    std::uint64_t total = 0;
    const auto index = whole_number(wanted);
    if (index && *index < frame.objects) {
        found.push_back(std::uint32_t(*index));
        ++total;
    }
    if (!wanted.empty()) {
        for (std::uint32_t i = 0; i < std::min<std::uint64_t>(frame.objects, contents.names.size()); ++i) {
            if (index && i == *index) continue;
            if (lower_case(contents.names[i]).find(wanted) == std::string::npos) continue;
            ++total;
            if (found.size() < max_found) found.push_back(i);
        }
    }
    Json list = Json::array();
    for (const std::uint32_t object : found) {
        list.push_back({{"index", object}, {"name", name_of(contents, object)}});
    }
    return json_answer({{"total", total}, {"found", list}});
}

Box3d region_of(const Address& address) {
    const auto corner = [&](const std::string& name, double* out) {
        std::string_view text = address.parameter(name);
        for (int i = 0; i < 3; ++i) {
            const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), out[i]);
            const bool last = i == 2, ended = end == text.data() + text.size();
            if (error != std::errc() || !std::isfinite(out[i]) || last != ended || (!last && *end != ',')) {
                throw Error(ErrorCode::bad_input, name + ": not three numbers with commas between");
            }
            if (!last) text.remove_prefix(std::size_t(end - text.data()) + 1);
        }
    };
    Box3d region;
    corner("min", region.min);
    corner("max", region.max);
    return region;
}

Answer near_answer(const ShownFrame& frame, const Box3d& region) {
    struct Found {
        double size;
        std::uint32_t object;
    };
    std::vector<Found> found;
    for (std::uint32_t i = 0; i < frame.objects; ++i) {
        if (frame.shown.row_of(i) != ShownObjects::none || !frame.data.has(i)) continue;
        const Box3d box = box_of(frame.data, i);
        if (!overlap(box, region)) continue;
        found.push_back({std::max({box.max[0] - box.min[0], box.max[1] - box.min[1], box.max[2] - box.min[2]}), i});
    }
    const std::uint32_t total = std::uint32_t(found.size());
    const std::size_t count = std::min(found.size(), max_near);
    std::partial_sort(
        found.begin(), found.begin() + std::ptrdiff_t(count), found.end(),
        [](const Found& a, const Found& b) { return a.size != b.size ? a.size > b.size : a.object < b.object; });
    const std::vector<std::uint32_t> counts = pair_counts(frame.data, frame.objects);
    std::vector<std::uint32_t> objects, partners;
    std::vector<RelativeBox> boxes;
    for (const Found& one : std::span(found).first(count)) {
        objects.push_back(one.object);
        partners.push_back(counts[one.object]);
        boxes.push_back(relative(box_of(frame.data, one.object), frame.origin));
    }
    Answer answer;
    const std::array<std::uint32_t, 2> head = {total, std::uint32_t(count)};
    append_array(answer.body, std::span<const std::uint32_t>(head));
    append_array(answer.body, std::span<const std::uint32_t>(objects));
    append_array(answer.body, std::span<const RelativeBox>(boxes));
    append_array(answer.body, std::span<const std::uint32_t>(partners));
    return answer;
}

}  // namespace octopair::viewer
