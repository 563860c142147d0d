#include "cli/command/config_file.hpp"

#include <algorithm>
#include <cerrno>
#include <fstream>
#include <optional>
#include <set>
#include <sstream>
#include <vector>

#include "base/io_failure.hpp"
#include "octopair/error.hpp"

namespace octopair::cli {

namespace {

[[noreturn]] void refuse(const std::string& file, const std::string& key, const std::string& why) {
    throw Error(ErrorCode::usage, file + ": " + key + ": " + why);
}

/// Returns the text of a file. Refuses other data: messages about them would show them, which may be secret or garble the terminal.
std::string text_of(const std::string& file) {
    constexpr std::size_t max_bytes = 1 << 20;
    std::ifstream in(file, std::ios::binary);
    if (!in) fail_io(file, "cannot open", errno);
    std::string text(max_bytes + 1, '\0');
    in.read(text.data(), std::streamsize(text.size()));
    if (in.bad()) fail_io(file, "cannot read", errno);
    text.resize(std::size_t(in.gcount()));
    const auto is_control = [](char c) {
        return (c >= 0 && c < ' ' && c != '\n' && c != '\r' && c != '\t') || c == 0x7F;
    };
    if (text.size() > max_bytes || std::any_of(text.begin(), text.end(), is_control))
        throw Error(ErrorCode::bad_input, file + ": not a text file of at most 1 MiB");
    return text;
}

std::vector<ConfigEntry> entries_of(const std::string& file) {
    std::istringstream text(text_of(file));
    return parse_config(text);
}

}  // namespace

void apply_config(const Command& command, const std::string& file) {
    std::set<std::string> seen;
    for (const auto& [key, values] : entries_of(file)) {
        std::optional<Option> option = command.find_option("--" + key);
        if (!option || key == "config" || key == "help") {
            refuse(file, key, "not an option of '" + command.name() + "'");
        }
        if (!seen.insert(key).second) refuse(file, key, "set twice");
        if (option->is_given()) continue;
        if (values.size() != 1) refuse(file, key, "needs exactly one value");
        try {
            option->set_text(values.front());
        } catch (const Error& error) {
            refuse(file, key, error.what());
        }
    }
}

}  // namespace octopair::cli
