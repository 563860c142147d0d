// Readers of options: configuration files and numbers.
#include "cli/command/command.hpp"
#include "cli/command/option_values.hpp"
#include "near_miss/readers.hpp"
#include "octopair/error.hpp"

namespace octopair::test {

/// The options are some of those of `octopair serve`, one of each kind of value.
void read_config(const NearMissFile& file, Values& values) {
    cli::CommandLine line("octopair", "", "");
    cli::Command serve = line.program();
    std::string listen = "none", state = "none", log = "none";
    std::uint64_t threads = 0, memory = 0;
    double grace = 0;
    bool quiet = false;
    serve.add_option("--listen", listen);
    serve.add_option("--state", state);
    const auto read_log = [&](const std::string& text) {
        cli::check_value("--log", {"text", "json"}, text);
        log = text;
    };
    serve.add_option("--log", read_log, "");
    const auto read_threads = [&](const std::string& text) { threads = cli::parse_threads(text); };
    serve.add_option("--threads", read_threads, "");
    const auto read_memory = [&](const std::string& text) { memory = cli::parse_bytes("--max-memory", text); };
    serve.add_option("--max-memory", read_memory, "");
    const auto read_grace = [&](const std::string& text) { grace = cli::parse_length("--grace", text); };
    serve.add_option("--grace", read_grace, "");
    serve.add_flag("--quiet", quiet, "");
    char name[] = "octopair";
    char* arguments[] = {name, nullptr};
    (void)line.parse(1, arguments);
    cli::apply_config(serve, file.path);
    for (const std::string& text : {listen, state, log}) values.text(text);
    values.whole(threads);
    values.whole(memory);
    values.number(grace);
    values.word(quiet ? "true" : "false");
}

void read_count(const NearMissFile& file, Values& values) {
    values.whole(cli::parse_count("f", file.content, 4294967295));
}

void read_bytes(const NearMissFile& file, Values& values) { values.whole(cli::parse_bytes("f", file.content)); }

void read_length(const NearMissFile& file, Values& values) { values.number(cli::parse_length("f", file.content)); }

}  // namespace octopair::test
