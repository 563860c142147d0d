// Options that subcommands of octopair-bench share.
#pragma once

#include <algorithm>
#include <cstdint>
#include <limits>
#include <string>
#include <vector>

#include "cli/command/command.hpp"
#include "cli/command/numbers.hpp"
#include "octopair/error.hpp"
#include "samples/scenes.hpp"

namespace octopair::bench {

/// Returns a number of at least 1. Throws: Error{usage} that names the option.
inline std::uint64_t parse_some(const std::string& name, const std::string& text) {
    const std::uint64_t number = cli::parse_count(name, text, std::numeric_limits<std::uint32_t>::max());
    if (number == 0) throw Error(ErrorCode::usage, name + ": 0 is less than 1");
    return number;
}

/// Adds an option that takes numbers of at least 1, and sorts them.
template <typename Number>
void add_numbers(cli::Command& command, const std::string& name, std::vector<Number>& numbers,
                 const std::string& what) {
    command
        .add_option(
            name,
            [&numbers, name](const std::vector<std::string>& texts) {
                numbers.clear();
                for (const std::string& text : texts) numbers.push_back(Number(parse_some(name, text)));
                std::ranges::sort(numbers);
            },
            what)
        .type_name("N");
}

/// Adds --scene, which takes several kinds.
inline void add_scenes(cli::Command& command, std::vector<std::string>& scenes) {
    command
        .add_option(
            "--scene",
            [&scenes](const std::vector<std::string>& kinds) {
                for (const std::string& kind : kinds) (void)samples::scene_description(kind);
                scenes = kinds;
            },
            "kinds of octopair generate (default uniform)")
        .type_name("KIND");
}

/// Adds --rounds.
inline void add_rounds(cli::Command& command, unsigned& rounds) {
    command
        .add_option(
            "--rounds", [&rounds](const std::string& text) { rounds = unsigned(parse_some("--rounds", text)); },
            "calls of each, of which the median counts (default " + std::to_string(rounds) + ')')
        .type_name("R");
}

/// Adds --mpirun.
inline cli::Option add_mpirun(cli::Command& command, std::string& mpirun) {
    return command.add_option("--mpirun", mpirun, "the command that starts ranks (default mpirun)")
        .type_name("COMMAND");
}

}  // namespace octopair::bench
