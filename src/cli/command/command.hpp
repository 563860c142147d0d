// Commands of a program and their options.
//
// `Command` and `Option` are handles: copies name the same command or option of a `CommandLine`, which must outlive them.
// Only command.cpp includes CLI11, because its header takes 5 seconds to compile.
#pragma once

#include <functional>
#include <iosfwd>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace CLI {  // NOLINT(readability-identifier-naming): not ours
class App;
class Option;
}  // namespace CLI

namespace octopair::cli {

/// An option or a positional argument. The setters return the option itself.
class Option {
public:
    explicit Option(CLI::Option& option) : option_(&option) {}

    Option required();
    /// The help's word for the value.
    Option type_name(const std::string& word);
    Option description(const std::string& text);
    /// Leaves the option out of the help.
    Option hide();
    /// The environment variable that gives the value where the command line does not.
    Option environment(const std::string& variable);
    Option needs(Option other);
    Option excludes(Option other);
    /// `fault` returns what is wrong with a value, or an empty string.
    Option check(std::function<std::string(const std::string& text)> fault);

    /// Returns whether the option has a value: of the command line, the environment, or set_text().
    bool is_given() const;
    /// Gives the option a value as if the value stood on the command line, and reads the value.
    /// Throws: Error{usage} if it is not a value of this option; what reading throws.
    void set_text(const std::string& text);

private:
    CLI::Option* option_;
};

/// The program, or a subcommand. A name `--NAME` is an option; a name without dashes is a positional argument.
class Command {
public:
    using ReadText = std::function<void(const std::string& text)>;
    using ReadTexts = std::function<void(const std::vector<std::string>& texts)>;

    explicit Command(CLI::App& app) : app_(&app) {}

    std::string name() const;
    Command add_subcommand(const std::string& name, const std::string& description);
    /// The command line must have exactly one of the subcommands.
    void require_subcommand();
    /// The last part of the help.
    void footer(const std::string& text);
    /// `done` runs once all options are read.
    void callback(std::function<void()> done);

    /// Requires: `value` and `values` outlive the parsing; so does what `read` borrows.
    Option add_option(const std::string& name, std::string& value, const std::string& description = {});
    Option add_option(const std::string& name, std::vector<std::string>& values, const std::string& description);
    Option add_option(const std::string& name, const ReadText& read, const std::string& description);
    Option add_option(const std::string& name, const ReadTexts& read, const std::string& description);
    Option add_flag(const std::string& name, bool& value, const std::string& description);
    std::optional<Option> find_option(const std::string& name) const;

private:
    CLI::App* app_;
};

/// The parser of the whole command line.
class CommandLine {
public:
    /// `version`: the text that --version prints.
    CommandLine(const std::string& name, const std::string& description, const std::string& version);
    ~CommandLine();

    Command program() { return Command(*app_); }

    /// Reads all options, and runs the callbacks of the commands. Returns the exit status if help or version was printed
    /// instead. Throws: Error{usage} for a wrong command line; what reading and the callbacks throw.
    std::optional<int> parse(int argc, char** argv);

private:
    std::unique_ptr<CLI::App> app_;
};

/// A line KEY = VALUE or KEY = [VALUE, ...] of a configuration file.
struct ConfigEntry {
    std::string key;  ///< with the sections around it, if any: SECTION.KEY
    std::vector<std::string> values;
};

/// Returns the entries of a file in TOML. Only for callbacks of commands: CommandLine::parse() reports syntax errors.
std::vector<ConfigEntry> parse_config(std::istream& file);

}  // namespace octopair::cli
