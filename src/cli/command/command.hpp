// Commands of a program and their options.
//
// `Command` and `Option` are handles into a `CommandLine`: copies of a handle refer to one command or option. Requires: the CommandLine
// outlives its handles.
// Only command.cpp includes CLI11, because its header takes 5 seconds to compile.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "cli/command/help_text.hpp"

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
    /// Sets the word for the value in the help.
    Option type_name(const std::string& word);
    Option description(const std::string& text);
    /// Hides the option from the help.
    Option hide();
    /// Sets the environment variable that gives the value if the command line does not.
    Option environment(const std::string& variable);
    Option needs(Option other);
    Option excludes(Option other);
    /// Adds a check. `fault` returns what is wrong with a value, or an empty string.
    Option check(std::function<std::string(const std::string& text)> fault);

    /// Returns whether the option has a value from the command line, the environment, or set_text().
    bool is_given() const;
    /// Sets and parses a value, as if it were on the command line. The value of a flag is true or false.
    /// Throws: Error{usage} if the value is invalid; what the option's reader throws.
    void set_text(const std::string& text);

private:
    CLI::Option* option_;
};

/// An option with a value.
struct GivenOption {
    std::string name;  ///< with dashes, such as --margin; for a positional argument, its name without dashes
    std::vector<std::string> texts;
};

/// Parts of the help after the options.
struct HelpParts {
    std::vector<HelpSection> sections;
    std::vector<std::string> examples;
};

/// The program, or a subcommand. A name `--NAME`, or `-N,--NAME` with a short form, makes an option. A name without dashes makes a
/// positional argument.
class Command {
public:
    using ReadText = std::function<void(const std::string& text)>;
    using ReadTexts = std::function<void(const std::vector<std::string>& texts)>;

    std::string name() const;
    Command add_subcommand(const std::string& name, const std::string& description);
    /// Requires exactly one of the subcommands on the command line.
    void require_subcommand();
    /// Accepts any further arguments, and ignores them.
    void ignore_other_arguments();
    /// Puts the options and arguments that are added from now on into a section of the help.
    void begin_section(const std::string& title);
    /// Adds a section to the help after all options.
    void add_help_section(HelpSection section);
    /// Sets the command lines at the end of the help. Requires: at most 58 characters each, so that they fit narrow terminals.
    void set_examples(std::vector<std::string> lines);
    /// Sets a function that runs after all options are parsed.
    void callback(std::function<void()> done);

    // Add an option whose value parse() stores or passes to `read`.
    // Requires, for all overloads: `value`, `values`, and the objects that `read` borrows exist until parse() returns.

    /// Refuses an empty value. A script whose variable is not set would pass one, and the option would have no effect.
    Option add_option(const std::string& name, std::string& value, const std::string& description = {});
    Option add_option(const std::string& name, std::vector<std::string>& values, const std::string& description);
    Option add_option(const std::string& name, const ReadText& read, const std::string& description);
    Option add_option(const std::string& name, const ReadTexts& read, const std::string& description);
    Option add_flag(const std::string& name, bool& value, const std::string& description);
    std::optional<Option> find_option(const std::string& name) const;
    /// Returns the names of the options that the help shows, without dashes.
    std::vector<std::string> option_names() const;
    /// Returns the options that have values. Requires: the command line was parsed.
    std::vector<GivenOption> given_options() const;

private:
    friend class CommandLine;
    explicit Command(CLI::App& app);

    CLI::App* app_;
    std::shared_ptr<HelpParts> parts_ = std::make_shared<HelpParts>();
};

/// The parser of the whole command line.
class CommandLine {
public:
    /// `version` is the text that --version prints.
    CommandLine(const std::string& name, const std::string& description, const std::string& version);
    ~CommandLine();

    Command program() const { return program_; }

    /// Parses all options, and runs the callbacks of the commands. Returns nothing, or the exit status if the help or the
    /// version was printed instead. `help [SUBCOMMAND]` means `[SUBCOMMAND] --help`.
    /// Throws: Error{usage} for an invalid command line; what readers of options and callbacks throw.
    std::optional<int> parse(int argc, char** argv);

private:
    std::unique_ptr<CLI::App> app_;
    Command program_;
};

// config_file.cpp

/// Sets the options of `file` that the command line does not set. A line `NAME = VALUE` of the file sets the option --NAME.
/// Requires: `command` was parsed.
/// Throws: Error{usage} that names the file, and the option or the line; Error{io_failed, bad_input} if the file cannot be read.
void apply_config(const Command& command, const std::string& file);

}  // namespace octopair::cli
