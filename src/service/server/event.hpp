// Events: lines of the server's log that programs read as well as people.
//
//   text   2026-01-31T12:00:00.000Z info job ended id=... pairs=12
//   JSON   {"time":"2026-01-31T12:00:00.000Z","level":"info","message":"job ended","id":"...","pairs":12}
//
// Any logger takes them; one of make_log writes what else is logged in the same form.
#pragma once

#include <spdlog/logger.h>

#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

namespace octopair::service {

struct Field {
    std::string_view name;
    std::variant<std::uint64_t, double, std::string> value;
};

void log_event(spdlog::logger& log, spdlog::level::level_enum level, std::string_view what,
               const std::vector<Field>& fields);

enum class LogForm : std::uint8_t { text, json };

/// What gRPC writes to standard error by itself goes to this log, of the whole process. Call it once, at its start.
void take_grpc_log(const std::shared_ptr<spdlog::logger>& log);

/// Writes to `sink`; without one, to standard error.
std::shared_ptr<spdlog::logger> make_log(LogForm form, spdlog::sink_ptr sink = nullptr);

}  // namespace octopair::service
