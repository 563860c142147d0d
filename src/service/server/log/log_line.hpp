// LogLine: one line of the server's log, formatted as text or as JSON (event.hpp shows both).
#pragma once

#include <chrono>
#include <string>
#include <string_view>
#include <vector>

#include "service/server/log/event.hpp"

namespace octopair::service {

struct LogLine {
    std::chrono::system_clock::time_point time;
    std::string level;
    std::string_view message;
    std::string_view fields;  ///< result of json_of, or empty
};

/// Returns `fields` as a JSON object. Control characters in strings become question marks.
std::string json_of(const std::vector<Field>& fields);

/// Returns the line with its line feed. Control characters in the message become question marks.
std::string format_line(LogForm form, const LogLine& line);

}  // namespace octopair::service
