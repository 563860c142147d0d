#include "cli/command/command.hpp"

#include <CLI/CLI.hpp>

#include <algorithm>
#include <string_view>
#include <utility>

#include "cli/command/suggestion.hpp"
#include "octopair/error.hpp"

namespace octopair::cli {

namespace {

bool takes_several(const CLI::Option& option) {
    return option.get_expected_max() == CLI::detail::expected_max_vector_size;
}

/// Returns the long name of an option or the name of an argument, and the word for its value.
std::string usage_of(const CLI::Option& option) {
    const bool has_value = option.get_expected_min() > 0 && !option.get_positional();
    return option.get_name() + (has_value ? ' ' + option.get_type_name() : "") + (takes_several(option) ? "..." : "");
}

HelpEntry help_entry_of(const CLI::Option& option) {
    const bool has_short_name = !option.get_positional() && !option.get_snames().empty();
    const std::string short_name = has_short_name ? '-' + option.get_snames().front() + ", " : "";
    const bool is_required = option.get_required() && !option.get_positional();
    return {short_name + usage_of(option), option.get_description() + (is_required ? " (required)" : "")};
}

/// Returns the options and arguments that the help shows, in its order: first those in sections with a title.
std::vector<const CLI::Option*> shown_options(const CLI::App& app) {
    auto options = app.get_options([](const CLI::Option* option) { return !option->get_group().empty(); });
    const auto has_title = [](const CLI::Option* option) { return option->get_group() != "Options"; };
    const auto untitled = std::stable_partition(options.begin(), options.end(), has_title);
    // The options that CLI11 adds itself come last.
    std::stable_partition(untitled, options.end(), [&](const CLI::Option* option) {
        return option != app.get_help_ptr() && option != app.get_version_ptr();
    });
    return options;
}

std::vector<HelpSection> option_sections(const CLI::App& app) {
    std::vector<HelpSection> sections;
    for (const CLI::Option* const option : shown_options(app)) {
        const bool begins = sections.empty() || sections.back().title != option->get_group();
        if (begins) sections.push_back({option->get_group(), {}});
        sections.back().entries.push_back(help_entry_of(*option));
    }
    const bool has_only_help = sections.size() > 1 && sections.back().entries.size() == 1;
    if (has_only_help) sections.back().title = "Help";
    return sections;
}

HelpSection subcommand_section(const CLI::App& app) {
    HelpSection section{"Subcommands", {}};
    for (const CLI::App* const subcommand : app.get_subcommands({})) {
        section.entries.push_back({subcommand->get_name(), subcommand->get_description()});
    }
    return section;
}

/// Returns the arguments, the required options and [OPTIONS].
std::string usage_of(const CLI::App& app) {
    std::string usage = app.get_subcommands({}).empty() ? "" : "SUBCOMMAND ";
    for (const CLI::Option* const option : shown_options(app)) {
        if (option->get_positional() && !option->get_required()) usage += '[' + usage_of(*option) + "] ";
        if (option->get_required()) usage += usage_of(*option) + ' ';
    }
    return usage + "[OPTIONS]";
}

Help help_of(const CLI::App& app, const std::string& name, const HelpParts& parts) {
    Help help{app.get_description(), name, usage_of(app), option_sections(app), parts.examples, {}};
    help.sections.insert(help.sections.end(), parts.sections.begin(), parts.sections.end());
    if (app.get_subcommands({}).empty()) return help;
    help.sections.insert(help.sections.begin(), subcommand_section(app));
    help.more = "Options of a subcommand: " + name + " SUBCOMMAND --help";
    return help;
}

std::vector<std::string> option_names_of(const CLI::App& app) {
    std::vector<std::string> names;
    for (const CLI::Option* const option : shown_options(app)) {
        for (const std::string& name : option->get_lnames()) names.push_back("--" + name);
    }
    return names;
}

std::vector<std::string> subcommand_names(const CLI::App& app) {
    std::vector<std::string> names;
    for (const CLI::App* const subcommand : app.get_subcommands({})) names.push_back(subcommand->get_name());
    return names;
}

std::string suggestion_for(const std::string& word, const std::vector<std::string>& names) {
    return did_you_mean(word, {names.begin(), names.end()});
}

std::string hint(const std::string& command) { return " (see " + command + " --help)"; }

/// Returns what is wrong with a word that is no subcommand and no option of the program.
std::string stray_word(const CLI::App& program, const std::string& word) {
    const bool is_option = word.starts_with('-');
    const std::string name = word.substr(0, is_option ? word.find('=') : word.npos);
    for (const CLI::App* const subcommand : program.get_subcommands({})) {
        if (is_option && subcommand->get_option_no_throw(name) != nullptr)
            return name + ": an option of a subcommand; write it after the subcommand";
    }
    std::vector<std::string> names = option_names_of(program);
    if (!is_option) {
        names = subcommand_names(program);
        names.insert(names.end(), {"help", "--version"});
    }
    return name + (is_option ? ": no such option" : ": no such subcommand") + suggestion_for(name, names);
}

/// Returns the command line that means the same as `help` or `help SUBCOMMAND`.
/// Throws: Error{usage} if there is no such subcommand.
std::vector<std::string> help_request(const CLI::App& program, const std::vector<std::string>& words) {
    if (words.size() == 1) return {"--help"};
    const std::vector<std::string> names = subcommand_names(program);
    if (std::find(names.begin(), names.end(), words[1]) != names.end()) return {words[1], "--help"};
    throw Error(ErrorCode::usage, stray_word(program, words[1]) + hint(program.get_name()));
}

/// Returns what is wrong with a word that a subcommand does not have.
std::string unexpected_word(const CLI::App& command, const std::string& word) {
    if (!word.starts_with('-')) return word + ": one argument too many";
    const std::string name = word.substr(0, word.find('='));
    return name + ": no such option of " + command.get_name() + suggestion_for(name, option_names_of(command));
}

/// Returns what is wrong with an option, given its values and those of other options; otherwise an empty text.
std::string fault_of_option(const CLI::Option& option) {
    if (option.count() == 0) return option.get_required() ? option.get_name() + " is missing" : "";
    for (const CLI::Option* const other : option.get_needs()) {
        if (other->count() == 0) return option.get_name() + ": only with " + other->get_name();
    }
    for (const CLI::Option* const other : option.get_excludes()) {
        if (other->count() > 0) return option.get_name() + ": not with " + other->get_name();
    }
    const bool is_repeated = option.get_expected_max() == 1 && option.count() > 1;
    return is_repeated ? option.get_name() + ": given " + std::to_string(option.count()) + " times; give it once" : "";
}

/// Returns the first fault of the command line that this file finds. `named`: the subcommand, or the program if none is given.
std::string fault_of(const CLI::App& program, const CLI::App& named, const CLI::ParseError& error) {
    if (const auto words = program.remaining(); !words.empty()) return stray_word(program, words.front());
    if (&named == &program) {
        const std::vector<std::string> names = subcommand_names(program);
        return "no subcommand is given; subcommands: " + CLI::detail::join(names, ", ");
    }
    if (const auto words = named.remaining(); !words.empty()) return unexpected_word(named, words.front());
    for (const CLI::Option* const option : named.get_options()) {
        // CLI11 stops at an option without its value, and has not seen the options after it.
        const bool ends_here = std::string_view(error.what()).starts_with(option->get_name() + ": 1 required ");
        if (ends_here) return option->get_name() + ": a value is missing: " + usage_of(*option);
    }
    for (const CLI::Option* const option : named.get_options()) {
        if (std::string fault = fault_of_option(*option); !fault.empty()) return fault;
    }
    return error.what();
}

}  // namespace

Option Option::required() { return Option(*option_->required()); }

Option Option::type_name(const std::string& word) { return Option(*option_->type_name(word)); }

Option Option::description(const std::string& text) { return Option(*option_->description(text)); }

Option Option::hide() { return Option(*option_->group("")); }

Option Option::environment(const std::string& variable) { return Option(*option_->envname(variable)); }

Option Option::needs(Option other) { return Option(*option_->needs(other.option_)); }

Option Option::excludes(Option other) { return Option(*option_->excludes(other.option_)); }

Option Option::check(std::function<std::string(const std::string&)> fault) {
    return Option(*option_->check(std::move(fault)));
}

bool Option::is_given() const { return option_->count() > 0; }

void Option::set_text(const std::string& text) {
    const bool is_flag = option_->get_expected_min() == 0;
    if (is_flag && text != "true" && text != "false")
        throw Error(ErrorCode::usage, option_->get_name() + ": '" + text + "' is neither true nor false");
    try {
        option_->add_result(is_flag ? option_->get_flag_value(option_->get_lnames().front(), text) : text);
        option_->run_callback();
    } catch (const CLI::ParseError& error) {
        throw Error(ErrorCode::usage, error.what());
    }
}

Command::Command(CLI::App& app) : app_(&app) {
    app.formatter_fn([parts = parts_](const CLI::App* command, const std::string& name, CLI::AppFormatMode) {
        return help_text(help_of(*command, name, *parts), help_width());
    });
}

std::string Command::name() const { return app_->get_name(); }

Command Command::add_subcommand(const std::string& name, const std::string& description) {
    return Command(*app_->add_subcommand(name, description));
}

void Command::require_subcommand() { app_->require_subcommand(1); }

void Command::ignore_other_arguments() { app_->allow_extras(); }

void Command::begin_section(const std::string& title) { app_->option_defaults()->group(title); }

void Command::add_help_section(HelpSection section) { parts_->sections.push_back(std::move(section)); }

void Command::set_examples(std::vector<std::string> lines) { parts_->examples = std::move(lines); }

void Command::callback(std::function<void()> done) { app_->callback(std::move(done)); }

Option Command::add_option(const std::string& name, std::string& value, const std::string& description) {
    return Option(*app_->add_option(name, value, description)).check([](const std::string& text) {
        return text.empty() ? "must not be empty" : "";
    });
}

Option Command::add_option(const std::string& name, std::vector<std::string>& values, const std::string& description) {
    return Option(*app_->add_option(name, values, description));
}

Option Command::add_option(const std::string& name, const ReadText& read, const std::string& description) {
    return Option(*app_->add_option_function<std::string>(name, read, description));
}

Option Command::add_option(const std::string& name, const ReadTexts& read, const std::string& description) {
    return Option(*app_->add_option_function<std::vector<std::string>>(name, read, description));
}

Option Command::add_flag(const std::string& name, bool& value, const std::string& description) {
    return Option(*app_->add_flag(name, value, description));
}

std::optional<Option> Command::find_option(const std::string& name) const {
    CLI::Option* const option = app_->get_option_no_throw(name);
    return option == nullptr ? std::nullopt : std::optional(Option(*option));
}

std::vector<std::string> Command::option_names() const {
    std::vector<std::string> names = option_names_of(*app_);
    for (std::string& name : names) name.erase(0, 2);
    return names;
}

std::vector<GivenOption> Command::given_options() const {
    std::vector<GivenOption> given;
    for (const CLI::Option* const option : std::as_const(*app_).get_options()) {
        if (option->count() > 0) given.push_back({option->get_name(), option->results()});
    }
    return given;
}

CommandLine::CommandLine(const std::string& name, const std::string& description, const std::string& version)
    : app_(std::make_unique<CLI::App>(description, name)), program_(*app_) {
    app_->set_help_flag("-h,--help", "print this help");
    app_->set_version_flag("-V,--version", version, "print the version");
}

CommandLine::~CommandLine() = default;

std::optional<int> CommandLine::parse(int argc, char** argv) {
    std::vector<std::string> words(argv + 1, argv + argc);
    if (!words.empty() && words.front() == "help") words = help_request(*app_, words);
    std::reverse(words.begin(), words.end());  // the order that CLI11 takes
    try {
        app_->parse(words);
    } catch (const CLI::Success& success) {
        return app_->exit(success);
    } catch (const CLI::ParseError& error) {
        const std::vector<CLI::App*> given = app_->get_subcommands();
        const CLI::App& named = given.empty() ? *app_ : *given.front();
        const std::string command = app_->get_name() + (given.empty() ? "" : ' ' + named.get_name());
        throw Error(ErrorCode::usage, fault_of(*app_, named, error) + hint(command));
    }
    return std::nullopt;
}

}  // namespace octopair::cli
