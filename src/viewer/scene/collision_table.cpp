// The table of collisions of a frame.
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "octopair/error.hpp"
#include "viewer/scene/frame_answers.hpp"

namespace octopair::viewer {

namespace {

constexpr std::string_view class_words[] = {"unknown",     "clearance", "collision", "touching",
                                            "penetrating", "contained", "duplicate", "undecided"};
static_assert(std::size(class_words) == collision_classes);

/// Returns a contact as JSON. A contact with a known point but no known normal has the normal 0.
Json contact_json(const Contact& contact) {
    if (contact.normal == Point3d{}) return {{"point", json_of(contact.point)}};
    return {{"point", json_of(contact.point)}, {"normal", json_of(contact.normal)}, {"depth", contact.depth}};
}

constexpr std::size_t max_row_contacts = 16;

/// How bad the classes are, indexed by CollisionClass: objects that overlap are worse than objects that touch. Undecided pairs are the least
/// bad ones: their surfaces do not meet.
constexpr std::array<std::uint8_t, collision_classes> severities = {3, 1, 4, 2, 7, 6, 5, 0};

bool has_depth(const Finding& finding) { return finding.depth_kind != DepthKind::unknown || finding.depth > 0; }

void add_depth(Json& row, const Finding& finding) {
    if (!has_depth(finding)) return;
    row["depth"] = finding.depth;
    if (finding.depth_kind == DepthKind::least) row["depth_kind"] = "least";
    if (finding.depth_kind != DepthKind::at_least) return;
    row["depth_kind"] = "at_least";
    if (finding.depth_at_most > finding.depth && std::isfinite(finding.depth_at_most)) {
        row["depth_at_most"] = finding.depth_at_most;
    }
}

/// Adds the first contacts, at most `most`. If some are left out, adds their number or says that more exist.
void add_contacts(Json& row, const Finding& finding, std::size_t most) {
    if (finding.contacts.empty()) return;
    Json contacts = Json::array();
    for (std::size_t i = 0; i < std::min(most, finding.contacts.size()); ++i) {
        contacts.push_back(contact_json(finding.contacts[i]));
    }
    row["contacts"] = std::move(contacts);
    if (finding.contacts.size() > most) row["contact_count"] = finding.contacts.size();
    if (finding.more_contacts) row["more_contacts"] = true;
}

void add_thickness(Json& row, const Finding& finding) {
    constexpr std::array<std::string_view, 4> words = {"", "at_most", "at_least", "undecided"};
    if (finding.thickness_kind == ThicknessKind::unknown) return;
    row["thickness_kind"] = words[std::size_t(finding.thickness_kind)];
    if (finding.thickness_kind != ThicknessKind::undecided) row["thickness"] = finding.thickness;
}

void add_finding(Json& row, const Finding& finding) {
    row["class"] = class_words[std::size_t(finding.collision_class)];
    if (finding.collision_class > CollisionClass::clearance && finding.collision_class != CollisionClass::undecided) {
        add_depth(row, finding);
        add_thickness(row, finding);
    } else if (finding.collision_class != CollisionClass::undecided) {
        row["distance"] = finding.distance;
    }
    if (finding.collision_class == CollisionClass::clearance && finding.nearest[0] != finding.nearest[1]) {
        row["nearest"] = {json_of(finding.nearest[0]), json_of(finding.nearest[1])};
    }
    constexpr std::array<std::string_view, 4> open_words = {"", "a", "b", "ab"};
    if (const int open = int(finding.open[0]) + 2 * int(finding.open[1])) row["open"] = open_words[std::size_t(open)];
    if (finding.time > 0) row["time"] = finding.time;
}

/// Returns the length of the shortest translation along an axis that separates two boxes, or minus their largest gap.
double overlap_of(const Box3d& a, const Box3d& b) {
    double overlap = std::numeric_limits<double>::infinity();
    for (std::size_t axis = 0; axis < 3; ++axis) {
        overlap = std::min({overlap, a.max[axis] - b.min[axis], b.max[axis] - a.min[axis]});
    }
    return overlap;
}

/// Pairs without exact tests beyond this number stay in the order of their indices: it takes 0.1 s to compare the boxes of a million pairs.
constexpr std::size_t max_compared_overlaps = 4'000'000;

/// The place of a row in the order from the worst to the least one.
struct Rank {
    Severity severity;
    std::uint32_t row;
};

bool is_worse(const Rank& p, const Rank& q) {
    return p.severity != q.severity ? p.severity > q.severity : p.row < q.row;
}

class Table {
public:
    explicit Table(const ShownFrame& frame) : frame_(frame) {}

    Answer rows(const RowRequest& request) {
        std::vector<std::uint32_t> kept = select(request);
        // A frame may list only some of its pairs.
        const bool all = kept.size() == frame_.data.pairs.size();
        const std::uint64_t total = all ? std::max<std::uint64_t>(frame_.data.pair_count, kept.size()) : kept.size();
        const std::size_t from = std::size_t(std::min<std::uint64_t>(request.from, kept.size()));
        const std::size_t count = std::size_t(std::min<std::uint64_t>(request.count, kept.size() - from));
        sort(kept, request.sort, from + count);
        // A table may have 200,000 rows, so each becomes text on its own.
        std::string text = "{\"total\":" + std::to_string(total) + ",\"rows\":[";
        for (std::size_t i = from; i < from + count; ++i) {
            if (i > from) text += ',';
            text += json_answer(row(kept[i], {request.count > max_full_rows, i >= max_full_rows})).body;
        }
        return {AnswerKind::json, text + "]}"};
    }

private:
    /// Parts of a row that are left out.
    struct Omitted {
        bool names, contacts;
    };

    std::vector<std::uint32_t> select(const RowRequest& request) const {
        const std::string text = lower_case(request.text);
        const TextSearch search(frame_.contents, text);
        std::vector<std::uint32_t> kept;
        for (std::uint32_t i = 0; i < frame_.data.pairs.size(); ++i) {
            const auto [a, b] = frame_.data.pairs[i];
            if (request.object && a != *request.object && b != *request.object) continue;
            if (request.with && a != *request.with && b != *request.with) continue;
            if (!text.empty() && !search.finds(a) && !search.finds(b)) continue;
            kept.push_back(i);
        }
        return kept;
    }

    /// Puts the first `count` rows into their order. The others are left in any order, or dropped.
    void sort(std::vector<std::uint32_t>& rows, RowRequest::Sort order, std::size_t count) const {
        if (order == RowRequest::Sort::worst) {
            keep_worst(rows, count);
        } else if (order == RowRequest::Sort::began) {
            std::stable_partition(rows.begin(), rows.end(), [&](auto i) { return has_begun(frame_.data.pairs[i]); });
        }
    }

    /// Keeps the worst `count` rows, the worst first. Complexity: O(n log count), since a frame may have millions of pairs.
    void keep_worst(std::vector<std::uint32_t>& rows, std::size_t count) const {
        std::vector<Rank> worst;  // a heap; the least of them is in front
        for (const std::uint32_t i : rows) {
            const Rank rank = rank_of(i);
            if (worst.size() < count) {
                worst.push_back(rank);
                std::push_heap(worst.begin(), worst.end(), is_worse);
            } else if (!worst.empty() && is_worse(rank, worst.front())) {
                std::pop_heap(worst.begin(), worst.end(), is_worse);
                worst.back() = rank;
                std::push_heap(worst.begin(), worst.end(), is_worse);
            }
        }
        std::sort_heap(worst.begin(), worst.end(), is_worse);
        rows.resize(worst.size());
        std::transform(worst.begin(), worst.end(), rows.begin(), [](const Rank& rank) { return rank.row; });
    }

    Rank rank_of(std::uint32_t i) const {
        if (frame_.data.findings.empty()) {
            const bool compared = frame_.data.pairs.size() <= max_compared_overlaps;
            return {{severities[0], compared ? overlap(i).value_or(0) : 0}, i};
        }
        const Finding& finding = frame_.data.findings[i];
        return {severity_of(finding, has_depth(finding) ? 0 : overlap(i).value_or(0)), i};
    }

    /// Returns by how much the boxes of a pair overlap, if no exact test has computed a depth and the boxes are those of the objects.
    std::optional<double> overlap(std::uint32_t i) const {
        const FrameData& data = frame_.data;
        const auto [a, b] = data.pairs[i];
        if (!frame_.contents.has_boxes || !data.has(a) || !data.has(b)) return std::nullopt;
        if (!data.findings.empty()) {
            const CollisionClass found = data.findings[i].collision_class;
            if (found != CollisionClass::unknown && found != CollisionClass::collision) return std::nullopt;
            if (has_depth(data.findings[i])) return std::nullopt;
        }
        return overlap_of(box_of(data, a), box_of(data, b));
    }

    bool has_begun(Pair pair) const { return std::binary_search(frame_.began.begin(), frame_.began.end(), pair); }

    Json row(std::uint32_t i, const Omitted& omitted) const {
        const Pair pair = frame_.data.pairs[i];
        Json row = {{"a", pair.a}, {"b", pair.b}};
        const auto is_hidden = [&](std::uint32_t object) { return frame_.shown.row_of(object) == ShownObjects::none; };
        for (const auto& [key, object] : {std::pair("name_a", pair.a), std::pair("name_b", pair.b)}) {
            if (frame_.contents.names.empty() || (omitted.names && !is_hidden(object))) continue;
            row[key] = name_of(frame_.contents, object);
        }
        if (has_begun(pair)) row["change"] = "began";
        if (!frame_.data.changes.empty()) row["change"] = frame_.data.changes[i];
        if (!frame_.data.statuses.empty()) {
            const auto& [status, comment] = frame_.data.statuses[i];
            row["status"] = status;
            if (!comment.empty()) row["comment"] = comment;
        }
        if (!frame_.data.findings.empty()) {
            add_finding(row, frame_.data.findings[i]);
            add_contacts(row, frame_.data.findings[i], omitted.contacts ? 1 : max_row_contacts);
        }
        if (const auto overlapping = overlap(i)) row["overlap"] = *overlapping;
        if ((is_hidden(pair.a) || is_hidden(pair.b)) && frame_.data.has(pair.a) && frame_.data.has(pair.b)) {
            row["boxes"] = {json_of(box_of(frame_.data, pair.a)), json_of(box_of(frame_.data, pair.b))};
        }
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
    const auto object_of = [&](const std::string& name) -> std::optional<std::uint32_t> {
        if (address.parameter(name).empty()) return std::nullopt;
        return std::uint32_t(std::min<std::uint64_t>(count_of(address, name, 0), 0xFFFFFFFF));
    };
    request.object = object_of("object");
    request.with = object_of("with");
    request.text = address.parameter("q");
    const std::string_view sort = address.parameter("sort");
    if (sort == "worst") {
        request.sort = RowRequest::Sort::worst;
    } else if (sort == "began") {
        request.sort = RowRequest::Sort::began;
    } else if (!sort.empty() && sort != "pair") {
        throw Error(ErrorCode::bad_input, "sort: worst, pair or began");
    }
    return request;
}

Answer class_rows(const ShownFrame& frame) {
    constexpr std::uint8_t none = 0xFF;
    std::vector<std::uint8_t> classes(std::size_t(frame.objects), none);
    for (std::size_t i = 0; i < frame.data.pairs.size(); ++i) {
        const auto& findings = frame.data.findings;
        const std::uint8_t found = findings.empty() ? 0 : std::uint8_t(findings[i].collision_class);
        for (const std::uint32_t object : {frame.data.pairs[i].a, frame.data.pairs[i].b}) {
            std::uint8_t& worst = classes[object];
            if (worst == none || severities[found] > severities[worst]) worst = found;
        }
    }
    std::vector<std::uint8_t> rows;
    rows.reserve(frame.shown.size());
    for (const std::uint32_t object : frame.shown.objects()) rows.push_back(classes[object]);
    return binary_answer(std::span<const std::uint8_t>(rows));
}

std::string_view class_word(CollisionClass collision_class) { return class_words[std::size_t(collision_class)]; }

Severity severity_of(const Finding& finding, double overlap) {
    const std::uint8_t rank = severities[std::size_t(finding.collision_class)];
    if (finding.collision_class == CollisionClass::clearance) return {rank, -finding.distance};
    return {rank, has_depth(finding) ? finding.depth : overlap};
}

Answer gone_rows(std::span<const GoneCollision> gone) {
    Json rows = Json::array();
    for (const GoneCollision& collision : gone) {
        Json row = Json::object();
        for (std::size_t k = 0; k < 2; ++k) {
            const auto& [name, label, type, id] = collision.objects[k];
            for (const auto& [key, text] : {std::pair("name", &name), std::pair("label", &label),
                                            std::pair("type", &type), std::pair("id", &id)}) {
                if (!text->empty()) row[std::string(key) + (k == 0 ? "_a" : "_b")] = *text;
            }
        }
        add_finding(row, collision.finding);
        rows.push_back(std::move(row));
    }
    return json_answer(rows);
}

Answer collision_rows(const ShownFrame& frame, const RowRequest& request) { return Table(frame).rows(request); }

}  // namespace octopair::viewer
