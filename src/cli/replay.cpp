// octopair replay: runs the recorded calls of a scene again.
#include <fmt/format.h>

#include <algorithm>
#include <cstdio>
#include <memory>

#include "cli/command/interrupt.hpp"
#include "cli/command/option_values.hpp"
#include "cli/command/progress_line.hpp"
#include "cli/subcommands.hpp"
#include "io/files/input_file.hpp"
#include "scene/recording/replay.hpp"

namespace octopair::cli {

namespace {

struct ReplayRequest {
    std::string file;
    unsigned threads = 0;  // 0: one per core
    bool check = false;
    bool quiet = false;
};

std::string plural(std::uint64_t count, std::string_view what) {
    return fmt::format("{} {}{}", grouped(count), what, count == 1 ? "" : "s");
}

std::string times_text(std::vector<double> seconds) {
    if (seconds.empty()) return "none";
    std::sort(seconds.begin(), seconds.end());
    return fmt::format("median {:.3f} ms, slowest {:.3f} ms", seconds[seconds.size() / 2] * 1e3, seconds.back() * 1e3);
}

/// Returns a line if the recording ends within a step or a call, otherwise an empty text.
std::string ending_text(const ReplayReport& report) {
    if (report.unfinished) return "ending      within a step; the replay completed this step\n";
    if (report.cut) return "ending      within a call; the replay left this call out\n";
    return "";
}

std::string summary_text(const ReplayReport& report, bool checked) {
    std::string text =
        fmt::format("steps       {}, {} of them full detections\n", grouped(report.steps), grouped(report.full_steps));
    text += fmt::format("calls       {}\n", grouped(report.calls));
    text += fmt::format("objects     {} at the end\n", grouped(report.objects));
    text += fmt::format("pairs       {} at the end\n", grouped(report.pairs));
    text += fmt::format("events      {} began, {} ended\n", grouped(report.began), grouped(report.ended));
    text += fmt::format("step time   {}\n", times_text(report.seconds));
    if (checked) {
        const std::uint64_t compared = report.steps - (report.unfinished ? 1 : 0);
        text += fmt::format("check       {} compared, all equal to the recording\n", plural(compared, "step"));
    }
    return text + ending_text(report);
}

int run_replay(const ReplayRequest& request) {
    const Interrupt interrupt;
    const io::InputFile file(request.file, io::InputFile::Changes::allowed);
    const auto read = [&](std::uint64_t offset, std::span<std::byte> out) {
        file.read(offset, out, interrupt.token());
    };
    RecordingReader reader({request.file, file.size(), read});
    ProgressLine progress(!request.quiet);
    ReplayOptions options{request.threads, request.check};
    options.on_step = [&](const StepResult&) { progress.show("replaying", reader.progress()); };
    const ReplayReport report = replay(reader, options, interrupt.token());
    progress.clear();
    if (!request.quiet) fmt::print(stderr, "{}", summary_text(report, request.check));
    return 0;
}

}  // namespace

void add_replay(Command& program, Action& action) {
    Command command = program.add_subcommand("replay", "run the recorded calls of a scene again");
    const auto request = std::make_shared<ReplayRequest>();
    command.begin_section("Input");
    command.add_option("FILE", request->file, "recording, made with SceneOptions::recording").required();
    command.begin_section("Replay");
    command
        .add_option(
            "--threads", [request](const std::string& text) { request->threads = parse_threads(text); },
            "threads (default 0: one per core)")
        .type_name("N");
    command.add_flag("--check", request->check, "compare each step with the recording; exit status 6 if they differ");
    command.add_flag("--quiet", request->quiet, "no progress and no summary on standard error");
    command.set_examples({"octopair replay game.rec --check"});
    command.callback([request, &action] { action = [request] { return run_replay(*request); }; });
}

}  // namespace octopair::cli
