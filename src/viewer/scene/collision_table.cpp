// The table of collisions of a frame.
#include <algorithm>

#include "octopair/error.hpp"
#include "viewer/scene/frame_answers.hpp"

namespace octopair::viewer {

namespace {

constexpr std::string_view class_words[] = {"unknown",     "clearance", "collision", "touching",
                                            "penetrating", "contained", "duplicate"};

/// Returns a contact as JSON. A contact with a known point but no known normal has the normal 0.
Json contact_json(const Contact& contact) {
    if (contact.normal == Point3d{}) return {{"point", json_of(contact.point)}};
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

}  // namespace octopair::viewer
