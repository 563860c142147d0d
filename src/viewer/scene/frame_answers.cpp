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

std::string_view name_of(const SceneContents& contents, std::uint32_t object) {
    return object < contents.names.size() ? std::string_view(contents.names[object]) : std::string_view();
}

std::string lower_case(std::string_view text) {
    std::string out(text);
    for (char& c : out) c = c >= 'A' && c <= 'Z' ? char(c | 0x20) : c;
    return out;
}

TextSearch::TextSearch(const SceneContents& contents, std::string_view text) : contents_(contents), text_(text) {
    for (const std::string& word : contents.details.words) {
        found_.push_back(lower_case(word).find(text_) != std::string::npos);
    }
}

bool TextSearch::finds(std::uint32_t object) const {
    if (std::to_string(object) == text_) return true;
    if (lower_case(name_of(contents_, object)).find(text_) != std::string::npos) return true;
    const auto& columns = contents_.details.columns;
    return std::any_of(columns.begin(), columns.end(), [&](const ObjectTexts::Column& column) {
        return object < column.words.size() && found_[column.words[object]];
    });
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
