#include "service/server/log/log_line.hpp"

#include <algorithm>
#include <array>
#include <ctime>
#include <nlohmann/json.hpp>

namespace octopair::service {

namespace {

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

}  // namespace

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

}  // namespace octopair::service
