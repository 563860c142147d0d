// Lines of the log of a server, with named fields for programs and people.
//
//   text   2026-01-31T12:00:00.000Z info job ended id=... pairs=12
//   JSON   {"time":"2026-01-31T12:00:00.000Z","level":"info","message":"job ended","id":"...","pairs":12}
//
// Every spdlog logger accepts lines with fields. A logger of make_log() writes other lines in the same form. Only log_line.cpp includes
// the headers of spdlog: they take a second to compile, and each formatted call takes another second.
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

/// Writes a line with fields.
void log_line(spdlog::logger& log, LogLevel level, std::string_view what, const std::vector<Field>& fields);
/// Writes a line without fields.
void log_text(spdlog::logger& log, LogLevel level, std::string_view text);

enum class LogForm : std::uint8_t { text, json };

/// Redirects the messages of gRPC and protobuf from standard error to `log`, for the whole process. Call it once, at the start
/// of the process.
void take_grpc_log(const std::shared_ptr<spdlog::logger>& log);

/// Returns a logger that writes to `sink`, or to standard error if `sink` is null.
std::shared_ptr<spdlog::logger> make_log(LogForm form, std::shared_ptr<spdlog::sinks::sink> sink = nullptr);

}  // namespace octopair::service
