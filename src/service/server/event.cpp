#include "service/server/event.hpp"

#include <fmt/chrono.h>
#include <google/protobuf/stubs/logging.h>
#include <grpc/support/log.h>
#include <spdlog/formatter.h>
#include <spdlog/sinks/stdout_sinks.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <nlohmann/json.hpp>

namespace octopair::service {

namespace {

/// Between an event's words and its fields, which follow as a JSON object.
constexpr char border = '\x1f';

/// Where events come from, by which they are known: what a line's text holds may come from outside.
constexpr const char* origin = "event";

std::string clean(std::string text) {
    std::replace_if(
        text.begin(), text.end(), [](char c) { return static_cast<unsigned char>(c) < 0x20 || c == 0x7f; }, '?');
    return text;
}

std::string json_text(const nlohmann::ordered_json& value) {
    return value.dump(-1, ' ', false, nlohmann::ordered_json::error_handler_t::replace);
}

std::string time_of(const spdlog::details::log_msg& line) {
    const auto since = line.time.time_since_epoch();
    const auto seconds = std::chrono::duration_cast<std::chrono::seconds>(since);
    const auto rest = std::chrono::duration_cast<std::chrono::milliseconds>(since - seconds);
    return fmt::format("{:%Y-%m-%dT%H:%M:%S}.{:03}Z", fmt::gmtime(std::time_t(seconds.count())), rest.count());
}

/// Words that have spaces are quoted.
std::string text_field(const std::string& name, const nlohmann::ordered_json& value) {
    if (!value.is_string()) return " " + name + "=" + json_text(value);
    const std::string words = value.get<std::string>();
    const bool plain = !words.empty() && words.find_first_of(" \"=") == std::string::npos;
    return " " + name + "=" + (plain ? words : json_text(value));
}

class Formatter final : public spdlog::formatter {
public:
    explicit Formatter(LogForm form) : form_(form) {}

    void format(const spdlog::details::log_msg& line, spdlog::memory_buf_t& out) override {
        const std::string_view payload(line.payload.data(), line.payload.size());
        const auto level = spdlog::level::to_string_view(line.level);
        const bool is_event = line.source.filename == origin;
        const std::size_t end = is_event ? std::min(payload.find(border), payload.size()) : payload.size();
        const std::string words = clean(std::string(payload.substr(0, end)));
        nlohmann::ordered_json fields = nlohmann::ordered_json::object();
        if (end < payload.size()) fields = nlohmann::ordered_json::parse(payload.substr(end + 1), nullptr, false);
        std::string text;
        if (form_ == LogForm::json) {
            nlohmann::ordered_json all = {
                {"time", time_of(line)}, {"level", std::string(level.data(), level.size())}, {"message", words}};
            all.update(fields);
            text = json_text(all);
        } else {
            text = time_of(line) + " " + std::string(level.data(), level.size()) + " " + words;
            for (const auto& [name, value] : fields.items()) text += text_field(name, value);
        }
        text += '\n';
        out.append(text.data(), text.data() + text.size());
    }
    std::unique_ptr<spdlog::formatter> clone() const override { return std::make_unique<Formatter>(form_); }

private:
    LogForm form_;
};

}  // namespace

void log_event(spdlog::logger& log, spdlog::level::level_enum level, std::string_view what,
               const std::vector<Field>& fields) {
    if (!log.should_log(level)) return;
    nlohmann::ordered_json object = nlohmann::ordered_json::object();
    for (const Field& field : fields) {
        const auto put = [&](const auto& value) {
            if constexpr (std::is_same_v<std::decay_t<decltype(value)>, std::string>)
                object[std::string(field.name)] = clean(value);
            else
                object[std::string(field.name)] = value;
        };
        std::visit(put, field.value);
    }
    log.log(spdlog::source_loc(origin, 1, ""), level, "{}{}{}", what, border, json_text(object));
}

namespace {

/// What gRPC has to say goes here; null: nowhere.
std::atomic<spdlog::logger*> grpc_log = nullptr;

void tell_of_grpc(gpr_log_func_args* line) {
    spdlog::logger* const log = grpc_log;
    if (log == nullptr) return;
    const bool is_error = line->severity == GPR_LOG_SEVERITY_ERROR;
    log->log(is_error ? spdlog::level::warn : spdlog::level::debug, "gRPC: {}", line->message);
}

void tell_of_protobuf(google::protobuf::LogLevel, const char*, int, const std::string& words) {
    if (spdlog::logger* const log = grpc_log) log->log(spdlog::level::debug, "protobuf: {}", words);
}

}  // namespace

void take_grpc_log(const std::shared_ptr<spdlog::logger>& log) {
    static std::shared_ptr<spdlog::logger> kept;
    kept = log;
    grpc_log = kept.get();
    gpr_set_log_function(&tell_of_grpc);
    google::protobuf::SetLogHandler(&tell_of_protobuf);
}

std::shared_ptr<spdlog::logger> make_log(LogForm form, spdlog::sink_ptr sink) {
    if (!sink) sink = std::make_shared<spdlog::sinks::stderr_sink_mt>();
    auto log = std::make_shared<spdlog::logger>("octopair", std::move(sink));
    log->set_formatter(std::make_unique<Formatter>(form));
    return log;
}

}  // namespace octopair::service
