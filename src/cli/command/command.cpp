#include "cli/command/command.hpp"

#include <CLI/CLI.hpp>

#include <utility>

#include "octopair/error.hpp"

namespace octopair::cli {

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

std::string Command::name() const { return app_->get_name(); }

Command Command::add_subcommand(const std::string& name, const std::string& description) {
    return Command(*app_->add_subcommand(name, description));
}

void Command::require_subcommand() { app_->require_subcommand(1); }

void Command::ignore_other_arguments() { app_->allow_extras(); }

void Command::footer(const std::string& text) { app_->footer(text); }

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

std::vector<GivenOption> Command::given_options() const {
    std::vector<GivenOption> given;
    for (const CLI::Option* const option : std::as_const(*app_).get_options()) {
        if (option->count() > 0) given.push_back({option->get_name(), option->results()});
    }
    return given;
}

CommandLine::CommandLine(const std::string& name, const std::string& description, const std::string& version)
    : app_(std::make_unique<CLI::App>(description, name)) {
    app_->set_version_flag("--version", version);
}

CommandLine::~CommandLine() = default;

std::optional<int> CommandLine::parse(int argc, char** argv) {
    try {
        app_->parse(argc, argv);
    } catch (const CLI::Success& success) {
        return app_->exit(success);
    } catch (const CLI::ParseError& error) {
        const std::vector<std::string> unknown = app_->remaining();
        const bool has_subcommand = !app_->get_subcommands().empty();
        // CLI11 would say only that a subcommand is missing.
        const std::string fault =
            has_subcommand || unknown.empty() ? error.what() : unknown.front() + ": no such subcommand";
        throw Error(ErrorCode::usage, fault + " (see " + app_->get_name() + " --help)");
    }
    return std::nullopt;
}

}  // namespace octopair::cli
