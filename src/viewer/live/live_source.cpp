#include "viewer/live/live_source.hpp"

#include "octopair/version.hpp"
#include "viewer/scene/frame_answers.hpp"

namespace octopair::viewer {

void LiveSource::connected(const std::string&, bool here) {
    if (here) {
        ++connections_;
        ++pages_;
    } else {
        --pages_;
    }
}

Answer LiveSource::view_answer(const FrameData& data) const {
    const std::size_t objects = std::visit([](auto span) { return span.size(); }, data.boxes);
    const Json has = {{"rows", false},     {"names", !contents_.names.empty()},
                      {"groups", false},   {"shapes", false},
                      {"contacts", false}, {"events", true},
                      {"search", true},    {"near", false}};
    std::vector<std::string> notices = contents_.notices;
    if (objects > feed_.most_shown()) {
        notices.push_back("Only the first " + grouped_number(feed_.most_shown()) + " of " + grouped_number(objects) +
                          " boxes are drawn.");
    }
    return json_answer({{"version", OCTOPAIR_VERSION},
                        {"title", contents_.title},
                        {"kind", "live"},
                        {"objects", objects},
                        {"shown", std::min(objects, feed_.most_shown())},
                        {"frames", 0},
                        {"origin", json_of(feed_.origin())},
                        {"bounds", json_of(bounds_of(data).value_or(no_bounds()))},
                        {"up", contents_.up},
                        {"unit", contents_.unit},
                        {"margin", contents_.margin},
                        {"has", has},
                        {"notices", notices},
                        {"summary", {{"pairs", data.pair_count}}}});
}

const Octants& LiveSource::octants(const ShownFrame& frame) {
    if (octants_of_ != frame.data.keep) {
        octants_ = viewer::octants_of(frame, 1);  // one thread, so that the scene keeps the others
        octants_of_ = frame.data.keep;
    }
    return octants_;
}

std::optional<Answer> LiveSource::get(const Address& address) {
    const LiveFeed::Frame latest = feed_.latest();
    const FrameData& data = latest.data;
    if (address.path() == "view.json") return view_answer(data);
    const std::size_t objects = std::visit([](auto span) { return span.size(); }, data.boxes);
    const ShownObjects shown = ShownObjects::first(std::min(objects, feed_.most_shown()));
    const Point3d origin = feed_.origin();
    const ShownFrame frame{contents_, objects, shown, origin, data, latest.began, latest.ended};
    if (address.path() == "names.json" && !contents_.names.empty()) {
        std::vector<std::string> names = contents_.names;
        names.resize(shown.size());
        return json_answer(names);
    }
    if (address.path() == "search.json") return search_answer(frame, address.parameter("q"));
    const std::vector<std::string_view> parts = address.parts();
    if (parts[0] == "collisions" && parts.size() == 2) return collision_rows(frame, row_request(address));
    if (parts[0] == "octants" && parts.size() == 2) return octant_summary(octants(frame));
    if (parts.size() != 3) return std::nullopt;
    const auto number = whole_number(parts[2].substr(0, parts[2].rfind('.')));
    if (!number) return std::nullopt;
    if (parts[0] == "octants" && *number <= OctalCode::max_level) {
        return octant_level(octants(frame), unsigned(*number), origin);
    }
    if (parts[0] != "object" || *number >= objects) return std::nullopt;
    return object_answer(frame, std::uint32_t(*number), &octants(frame));
}

}  // namespace octopair::viewer
