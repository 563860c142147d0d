// Events: lines of the server's log that programs read as well as people.
//
//   text   2026-01-31T12:00:00.000Z info job ended id=... pairs=12
//   JSON   {"time":"2026-01-31T12:00:00.000Z","level":"info","message":"job ended","id":"...","pairs":12}
//
// Any logger takes them; one of make_log writes what else is logged in the same form. spdlog itself is used in event.cpp
// alone: its headers take a second to compile, and each of its formatted calls as much again.
#pragma once

#include <spdlog/fwd.h>

#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

namespace octopair::service {

enum class LogLevel : std::uint8_t { debug, info, warning, error };

struct Field {
    std::string_view name;
    std::variant<std::uint64_t, double, std::string> value;
};

/// Returns whether the log keeps lines of this level.
bool is_logged(const spdlog::logger& log, LogLevel level);

void log_event(spdlog::logger& log, LogLevel level, std::string_view what, const std::vector<Field>& fields);
/// Writes a line for people alone: without fields.
void log_text(spdlog::logger& log, LogLevel level, std::string_view text);

enum class LogForm : std::uint8_t { text, json };

/// What gRPC writes to standard error by itself goes to this log, of the whole process. Call it once, at its start.
void take_grpc_log(const std::shared_ptr<spdlog::logger>& log);

/// Writes to `sink`; without one, to standard error.
std::shared_ptr<spdlog::logger> make_log(LogForm form, std::shared_ptr<spdlog::sinks::sink> sink = nullptr);

}  // namespace octopair::service
