// octopair info: prints version, build, engines and instruction set, or what files hold.
#include <fmt/format.h>

#include <memory>
#include <thread>

#include "cli/command/interrupt.hpp"
#include "cli/detect/pipeline_options.hpp"
#include "cli/engine_choice.hpp"
#include "cli/file_info.hpp"
#include "cli/subcommands.hpp"
#include "io/files/output_stream.hpp"
#include "octopair/version.hpp"
#include "octree/sweep/sweep.hpp"

namespace octopair::cli {

namespace {

#if defined(__clang__)
constexpr const char* compiler = "clang " __clang_version__;
#else
constexpr const char* compiler = "g++ " __VERSION__;
#endif

#ifdef NDEBUG
constexpr const char* checks = "without assertions";
#else
constexpr const char* checks = "with assertions";
#endif

#ifdef OCTOPAIR_WITH_MESHES
constexpr const char* meshes = ", mesh scenes (Assimp)";
#else
constexpr const char* meshes = "";
#endif

#ifdef OCTOPAIR_WITH_PIPELINE
constexpr const char* json_scenes = ", .json";
#else
constexpr const char* json_scenes = "";
#endif

#ifdef OCTOPAIR_WITH_SERVICE
constexpr const char* servers = ", server (ADDRESS)";
#else
constexpr const char* servers = "";
#endif

int run_file_info(const std::vector<std::string>& paths) {
    const Interrupt interrupt;
    const std::string text = describe_files(paths, interrupt.token());
    io::StandardOutput out({});
    out.write(text);
    out.commit();
    return 0;
}

int run_info() {
    io::StandardOutput out({});
    out.write(fmt::format("version          {}\n", OCTOPAIR_VERSION));
    out.write(fmt::format("build            {}, {}\n", compiler, checks));
    out.write(fmt::format("engines          {}{}\n", fmt::join(engine_names(), ", "), servers));
    out.write(fmt::format("stages           {}\n", fmt::join(stage_names(), ", ")));
    out.write(fmt::format("inputs           .npy, .csv{}{}\n", json_scenes, meshes));
    out.write(fmt::format("instruction set  {}\n", sweep_instruction_set()));
    out.write(fmt::format("cores            {}\n", std::thread::hardware_concurrency()));
    out.commit();
    return 0;
}

}  // namespace

void add_info(Command& program, Action& action) {
    Command command = program.add_subcommand("info", "print version, build and engines, or what files hold");
    const auto paths = std::make_shared<std::vector<std::string>>();
    command.add_option(
        "INPUT", *paths,
        "files to read: print format, unit, axes, objects, triangles, open meshes, what was not read, warnings");
    command.callback(
        [&action, paths] { action = [paths] { return paths->empty() ? run_info() : run_file_info(*paths); }; });
}

}  // namespace octopair::cli
