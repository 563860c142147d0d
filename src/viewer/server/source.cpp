#include "viewer/server/source.hpp"

#include <nlohmann/json.hpp>

namespace octopair::viewer {

namespace {

std::string message(const nlohmann::ordered_json& json) {
    return json.dump(-1, ' ', false, nlohmann::ordered_json::error_handler_t::replace);
}

}  // namespace

std::string progress_message(std::string_view what, double done) {
    return message({{"event", "progress"}, {"what", what}, {"done", done}});
}
std::string ready_message() { return message({{"event", "ready"}}); }
std::string failed_message(std::string_view why) { return message({{"event", "failed"}, {"message", why}}); }
std::string waiting_message(std::string_view why) { return message({{"event", "waiting"}, {"message", why}}); }
std::string timeline_message(std::uint64_t done) { return message({{"event", "timeline"}, {"done", done}}); }
std::string closed_message() { return message({{"event", "closed"}}); }

}  // namespace octopair::viewer
