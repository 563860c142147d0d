#include "cli/config_file.hpp"

#include <CLI/CLI.hpp>
#include <cerrno>
#include <fstream>
#include <set>
#include <vector>

#include "base/io_failure.hpp"
#include "octopair/error.hpp"

namespace octopair::cli {

namespace {

[[noreturn]] void refuse(const std::string& file, const std::string& key, const std::string& why) {
    throw Error(ErrorCode::usage, file + ": " + key + ": " + why);
}

std::vector<CLI::ConfigItem> items_of(const std::string& file) {
    std::ifstream in(file);
    if (!in) fail_io(file, "cannot open", errno);
    std::vector<CLI::ConfigItem> items = CLI::ConfigTOML().from_config(in);
    if (in.bad()) fail_io(file, "cannot read", errno);
    return items;
}

/// As if it stood on the command line; then its value is judged.
void give(CLI::Option& option, const CLI::ConfigItem& item) {
    if (item.inputs.size() != 1) throw Error(ErrorCode::usage, "one value is wanted");
    const bool is_flag = option.get_expected_min() == 0;
    option.add_result(is_flag ? option.get_flag_value(item.name, item.inputs.front()) : item.inputs.front());
    option.run_callback();
}

}  // namespace

void apply_config(CLI::App& command, const std::string& file) {
    std::set<std::string> seen;
    for (const CLI::ConfigItem& item : items_of(file)) {
        const std::string key = item.fullname();
        CLI::Option* const option = item.parents.empty() ? command.get_option_no_throw("--" + item.name) : nullptr;
        if (option == nullptr || item.name == "config" || item.name == "help") {
            refuse(file, key, "is no option of '" + command.get_name() + "'");
        }
        if (!seen.insert(key).second) refuse(file, key, "is there twice");
        if (option->count() > 0) continue;
        try {
            give(*option, item);
        } catch (const CLI::ParseError& error) {
            refuse(file, key, error.what());
        } catch (const Error& error) {
            refuse(file, key, error.what());
        }
    }
}

}  // namespace octopair::cli
