#include "cli/command/config_file.hpp"

#include <cerrno>
#include <fstream>
#include <optional>
#include <set>
#include <vector>

#include "base/io_failure.hpp"
#include "octopair/error.hpp"

namespace octopair::cli {

namespace {

[[noreturn]] void refuse(const std::string& file, const std::string& key, const std::string& why) {
    throw Error(ErrorCode::usage, file + ": " + key + ": " + why);
}

std::vector<ConfigEntry> entries_of(const std::string& file) {
    std::ifstream in(file);
    if (!in) fail_io(file, "cannot open", errno);
    std::vector<ConfigEntry> entries = parse_config(in);
    if (in.bad()) fail_io(file, "cannot read", errno);
    return entries;
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
