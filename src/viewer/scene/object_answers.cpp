// Answers about single objects of a frame.
#include <algorithm>

#include "viewer/scene/frame_answers.hpp"

namespace octopair::viewer {

std::optional<Answer> object_answer(const ShownFrame& frame, std::uint32_t object, const Octants* octants) {
    const SceneContents& contents = frame.contents;
    if (object >= frame.objects) return std::nullopt;
    Json json = {{"index", object}};
    if (!contents.names.empty()) json["name"] = name_of(contents, object);
    Json details = Json::object();
    for (const ObjectTexts::Column& column : contents.details.columns) {
        const std::string_view text = contents.details.of(column, object);
        if (!text.empty()) details[column.name] = text;
    }
    if (!details.empty()) json["details"] = std::move(details);
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
        const TextSearch search(contents, wanted);
        for (std::uint32_t i = 0; i < frame.objects; ++i) {
            if ((index && i == *index) || !search.finds(i)) continue;
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

}  // namespace octopair::viewer
