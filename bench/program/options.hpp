// Options common to several subcommands of octopair-bench.
#pragma once

#include <algorithm>
#include <cstdint>
#include <limits>
#include <string>
#include <vector>

#include "cli/command/command.hpp"
#include "cli/command/option_values.hpp"
#include "octopair/error.hpp"
#include "samples/scenes.hpp"

namespace octopair::bench {

struct Bounds {
    std::uint64_t least = 1;
    std::uint64_t most = std::numeric_limits<std::uint32_t>::max();
};

/// Returns a whole number within `bounds`. Throws: Error{usage} that names the option.
inline std::uint64_t parse_between(const std::string& name, const std::string& text, const Bounds& bounds = {}) {
    const std::uint64_t number = cli::parse_count(name, text, bounds.most);
    if (number >= bounds.least) return number;
    throw Error(ErrorCode::usage,
                name + ": " + std::to_string(number) + " is less than " + std::to_string(bounds.least));
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
                for (const std::string& text : texts) numbers.push_back(Number(parse_between(name, text)));
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
                for (const std::string& kind : kinds) cli::check_value("--scene", samples::scene_kinds(), kind);
                scenes = kinds;
            },
            "scene kinds of octopair generate (default uniform)")
        .type_name("KIND");
}

/// Adds --rounds.
inline void add_rounds(cli::Command& command, unsigned& rounds) {
    command
        .add_option(
            "--rounds", [&rounds](const std::string& text) { rounds = unsigned(parse_between("--rounds", text)); },
            "calls per measurement; the median counts (default " + std::to_string(rounds) + ')')
        .type_name("R");
}

/// Adds --mpirun.
inline cli::Option add_mpirun(cli::Command& command, std::string& mpirun) {
    return command.add_option("--mpirun", mpirun, "command that starts MPI ranks (default mpirun)")
        .type_name("COMMAND");
}

}  // namespace octopair::bench
