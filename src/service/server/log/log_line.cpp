#include "service/server/log/log_line.hpp"

#include <google/protobuf/stubs/common.h>
#include <grpc/support/log.h>
#include <grpcpp/version_info.h>
#include <spdlog/formatter.h>
#include <spdlog/logger.h>
#include <spdlog/sinks/stdout_sinks.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <ctime>
#include <nlohmann/json.hpp>
#include <utility>
#if __has_include(<google/protobuf/stubs/logging.h>)
#include <google/protobuf/stubs/logging.h>
#endif

namespace octopair::service {

namespace {

/// Separates the message of a line from its fields, a JSON object, in the payload of a log line.
constexpr char border = '\x1f';

/// Name that marks a log line with fields, in spdlog's member `source`. A mark in the text would not be safe: clients control parts of
/// the text.
constexpr const char* origin = "fields";

spdlog::level::level_enum spdlog_level(LogLevel level) {
    switch (level) {
        case LogLevel::debug:
            return spdlog::level::debug;
        case LogLevel::info:
            return spdlog::level::info;
        case LogLevel::warning:
            return spdlog::level::warn;
        case LogLevel::error:
            break;
    }
    return spdlog::level::err;
}

/// A line of the log, before it is formatted.
struct LogLine {
    std::chrono::system_clock::time_point time;
    std::string level;
    std::string_view message;
    std::string_view fields;  ///< result of json_of, or empty
};

using Json = nlohmann::ordered_json;

std::string clean(std::string text) {
    std::replace_if(
        text.begin(), text.end(), [](char c) { return static_cast<unsigned char>(c) < 0x20 || c == 0x7f; }, '?');
    return text;
}

std::string json_text(const Json& value) { return value.dump(-1, ' ', false, Json::error_handler_t::replace); }

/// Returns the time in UTC with milliseconds.
std::string time_text(std::chrono::system_clock::time_point time) {
    using std::chrono::milliseconds;
    const std::time_t seconds = std::chrono::system_clock::to_time_t(std::chrono::floor<std::chrono::seconds>(time));
    const auto rest = std::chrono::floor<milliseconds>(time.time_since_epoch()) % std::chrono::seconds(1);
    std::tm parts{};
    ::gmtime_r(&seconds, &parts);
    std::array<char, 32> text{};
    const std::size_t length = std::strftime(text.data(), text.size(), "%Y-%m-%dT%H:%M:%S", &parts);
    // The last three digits of 1000 to 1999: milliseconds with leading zeros.
    return std::string(text.data(), length) + "." + std::to_string(1000 + rest.count()).substr(1) + "Z";
}

/// Returns " NAME=VALUE". A string that is empty or has spaces, quotes or = is quoted.
std::string text_field(const std::string& name, const Json& value) {
    if (!value.is_string()) return " " + name + "=" + json_text(value);
    const std::string words = value.get<std::string>();
    const bool plain = !words.empty() && words.find_first_of(" \"=") == std::string::npos;
    return " " + name + "=" + (plain ? words : json_text(value));
}

/// Returns `fields` as a JSON object. Control characters in strings become question marks.
std::string json_of(const std::vector<Field>& fields) {
    Json object = Json::object();
    for (const Field& field : fields) {
        const auto put = [&](const auto& value) {
            if constexpr (std::is_same_v<std::decay_t<decltype(value)>, std::string>)
                object[std::string(field.name)] = clean(value);
            else
                object[std::string(field.name)] = value;
        };
        std::visit(put, field.value);
    }
    return json_text(object);
}

/// Returns the line with its line feed. Control characters in the message become question marks.
std::string format_line(LogForm form, const LogLine& line) {
    const std::string time = time_text(line.time), message = clean(std::string(line.message));
    const Json fields = line.fields.empty() ? Json::object() : Json::parse(line.fields, nullptr, false);
    if (form == LogForm::json) {
        Json all = {{"time", time}, {"level", line.level}, {"message", message}};
        all.update(fields);
        return json_text(all) + "\n";
    }
    std::string text = time + " " + line.level + " " + message;
    for (const auto& [name, value] : fields.items()) text += text_field(name, value);
    return text + "\n";
}

class Formatter final : public spdlog::formatter {
public:
    explicit Formatter(LogForm form) : form_(form) {}

    void format(const spdlog::details::log_msg& line, spdlog::memory_buf_t& out) override {
        const std::string_view payload(line.payload.data(), line.payload.size());
        const auto level = spdlog::level::to_string_view(line.level);
        const bool has_fields = line.source.filename == origin;
        const std::size_t end = has_fields ? std::min(payload.find(border), payload.size()) : payload.size();
        const std::string text =
            format_line(form_, {line.time, std::string(level.data(), level.size()), payload.substr(0, end),
                                payload.substr(std::min(end + 1, payload.size()))});
        out.append(text.data(), text.data() + text.size());
    }
    std::unique_ptr<spdlog::formatter> clone() const override { return std::make_unique<Formatter>(form_); }

private:
    LogForm form_;
};

/// Receives the messages of gRPC and protobuf; null: they are dropped.
std::atomic<spdlog::logger*> grpc_log = nullptr;

// Later versions of gRPC and protobuf have no handlers. They write messages to standard error by themselves.

#if GRPC_CPP_VERSION_MAJOR == 1 && GRPC_CPP_VERSION_MINOR < 65
void log_grpc_message(gpr_log_func_args* line) {
    spdlog::logger* const log = grpc_log;
    if (log == nullptr) return;
    const LogLevel level = line->severity == GPR_LOG_SEVERITY_ERROR ? LogLevel::warning : LogLevel::debug;
    if (is_logged(*log, level)) log_text(*log, level, std::string("gRPC: ") + line->message);
}

void take_grpc_messages() { gpr_set_log_function(&log_grpc_message); }
#else
void take_grpc_messages() {}
#endif

#if GOOGLE_PROTOBUF_VERSION < 4022000
void log_protobuf_message(google::protobuf::LogLevel, const char*, int, const std::string& words) {
    if (spdlog::logger* const log = grpc_log) log_text(*log, LogLevel::debug, "protobuf: " + words);
}

void take_protobuf_messages() { google::protobuf::SetLogHandler(&log_protobuf_message); }
#else
void take_protobuf_messages() {}
#endif

}  // namespace

bool is_logged(const spdlog::logger& log, LogLevel level) { return log.should_log(spdlog_level(level)); }

void log_line(spdlog::logger& log, LogLevel level, std::string_view what, const std::vector<Field>& fields) {
    if (!is_logged(log, level)) return;
    const std::string payload = std::string(what) + border + json_of(fields);
    log.log(spdlog::source_loc(origin, 1, ""), spdlog_level(level), spdlog::string_view_t(payload));
}

void log_text(spdlog::logger& log, LogLevel level, std::string_view text) {
    log.log(spdlog_level(level), spdlog::string_view_t(text.data(), text.size()));
}

void take_grpc_log(const std::shared_ptr<spdlog::logger>& log) {
    static std::shared_ptr<spdlog::logger> kept;
    kept = log;
    grpc_log = kept.get();
    take_grpc_messages();
    take_protobuf_messages();
}

std::shared_ptr<spdlog::logger> make_log(LogForm form, std::shared_ptr<spdlog::sinks::sink> sink) {
    if (!sink) sink = std::make_shared<spdlog::sinks::stderr_sink_mt>();
    auto log = std::make_shared<spdlog::logger>("octopair", std::move(sink));
    log->set_formatter(std::make_unique<Formatter>(form));
    return log;
}

}  // namespace octopair::service
