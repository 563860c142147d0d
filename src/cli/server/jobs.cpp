// octopair status, result, cancel, drain: show, collect and cancel the jobs of a server, and end the server.
#include <fmt/format.h>

#include <chrono>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>

#include "base/error_codes.hpp"
#include "cli/command/interrupt.hpp"
#include "cli/command/option_values.hpp"
#include "cli/command/progress_line.hpp"
#include "cli/detect/detect_options.hpp"
#include "cli/server/server_choice.hpp"
#include "cli/subcommands.hpp"
#include "io/formats/format_choice.hpp"
#include "io/results/pair_writer.hpp"
#include "octopair/error.hpp"
#include "octopair/job_client.hpp"

namespace octopair::cli {

namespace {

struct JobRequest {
    ServerChoice server;
    std::string id;
    std::optional<double> wait;
    bool json = false;
    std::string output;  ///< path of a file; empty means standard output
    bool keep = false, release = false;
    bool quiet = false;
};

constexpr const char* name_of(JobState state) {
    switch (state) {
        case JobState::queued:
            return "queued";
        case JobState::running:
            return "running";
        case JobState::done:
            return "done";
        case JobState::failed:
            return "failed";
        case JobState::cancelled:
            return "cancelled";
    }
    return "unknown";
}

std::string line_of(const JobStatus& status) {
    std::string line = fmt::format("{}  {}", status.id, name_of(status.state));
    if (status.state == JobState::queued) line += fmt::format(", {} before it", grouped(status.queued_before));
    if (status.state == JobState::running) line += fmt::format(", {:.0f}%", status.progress * 100);
    line += fmt::format(", {} objects", grouped(status.objects));
    if (status.state == JobState::done) line += fmt::format(", {} pairs", grouped(status.summary.pairs));
    if (status.error) line += fmt::format(": {}", status.error->what());
    if (status.waits_for_room) line += ", waits for room on the server's disk";
    if (!status.detached) line += " (attached)";
    if (!status.owner.empty()) line += fmt::format(", of {}", status.owner);
    return line + '\n';
}

nlohmann::ordered_json json_of(const JobStatus& status) {
    nlohmann::ordered_json json = {{"id", status.id},
                                   {"state", name_of(status.state)},
                                   {"detached", status.detached},
                                   {"objects", status.objects},
                                   {"count_only", status.count_only},
                                   {"progress", status.progress},
                                   {"queued_before", status.queued_before}};
    if (!status.owner.empty()) json["owner"] = status.owner;
    if (status.waits_for_room) json["waits_for_room"] = true;
    if (status.state == JobState::done) {
        json["pairs"] = status.summary.pairs;
        json["truncated"] = status.summary.truncated;
        json["seconds"] = status.summary.seconds;
    }
    if (status.error) json["error"] = {{"code", error_name(status.error->code())}, {"message", status.error->what()}};
    return json;
}

void print(const std::string& text, const std::stop_token& stop) {
    io::StandardOutput out(stop);
    out.write(text);
    out.commit();
}

std::string text_of(const JobRequest& request, const JobStatus& status) {
    return request.json ? json_of(status).dump(2) + '\n' : line_of(status);
}

int run_list(const JobRequest& request) {
    const Interrupt interrupt;
    JobClient client(request.server.address, client_options(request.server));
    std::string text;
    nlohmann::ordered_json all = nlohmann::ordered_json::array();
    for (const JobStatus& status : client.list(interrupt.token())) {
        request.json ? all.push_back(json_of(status)) : void(text += line_of(status));
    }
    print(request.json ? all.dump(2) + '\n' : text, interrupt.token());
    return 0;
}

int run_status(const JobRequest& request) {
    const Interrupt interrupt;
    JobClient client(request.server.address, client_options(request.server));
    const JobStatus status =
        request.wait ? client.wait(request.id, std::chrono::duration<double>(*request.wait), interrupt.token())
                     : client.status(request.id, interrupt.token());
    print(text_of(request, status), interrupt.token());
    return 0;
}

int run_cancel(const JobRequest& request) {
    const Interrupt interrupt;
    JobClient client(request.server.address, client_options(request.server));
    JobStatus status = client.cancel(request.id, interrupt.token());
    if (request.release) {
        status = client.wait(request.id, std::chrono::minutes(1), interrupt.token());
        client.release(request.id, interrupt.token());
    }
    print(text_of(request, status), interrupt.token());
    return 0;
}

int run_drain(const ServerChoice& server) {
    const Interrupt interrupt;
    JobClient(server.address, client_options(server)).drain(interrupt.token());
    return 0;
}

class Collection {
public:
    Collection(const JobRequest& request, std::stop_token stop)
        : request_(request), stop_(std::move(stop)), client_(request.server.address, client_options(request.server)) {}

    void run() {
        const bool count_only = client_.status(request_.id, stop_).count_only;
        if (count_only && !request_.output.empty()) {
            throw Error(ErrorCode::usage, "job " + request_.id + " only counts pairs; do not give --output");
        }
        try {
            count_only ? count() : stream();
        } catch (const Error& error) {
            // --release also removes a failed or cancelled job: it has no result that the user could lose.
            if (request_.release && has_no_result()) client_.release(request_.id, stop_);
            if (error.code() != ErrorCode::cancelled || stop_.stop_requested()) throw;
            throw Error(ErrorCode::engine_failed, "job " + request_.id + " was cancelled");
        }
        if (request_.release) client_.release(request_.id, stop_);
    }

private:
    bool has_no_result() {
        const JobState state = client_.status(request_.id, stop_).state;
        return state == JobState::failed || state == JobState::cancelled;
    }

    void count() {
        const Summary summary = client_.result(request_.id, PairSink(), progress(), stop_);
        line_.clear();
        print(std::to_string(summary.pairs) + '\n', stop_);
    }

    void stream() {
        const auto writer = request_.output.empty()
                                ? io::make_csv_writer(std::make_unique<io::StandardOutput>(stop_), false)
                                : io::make_file_writer(request_.output, false, {&no_names_, &no_names_});
        const PairSink sink = [&](std::span<const Pair> pairs) { writer->write(pairs); };
        writer->begin_frame(0);
        const Summary summary = client_.result(request_.id, sink, progress(), stop_);
        writer->end_frame();
        writer->finish();
        line_.clear();
        if (!request_.quiet) {
            fmt::print(stderr, "{} pairs{}\n", grouped(summary.pairs),
                       summary.truncated ? " (the limit was reached; more exist)" : "");
        }
    }

    ProgressSink progress() {
        return [this](double done) { line_.show("detecting", done); };
    }

    const JobRequest& request_;
    std::stop_token stop_;
    JobClient client_;
    ProgressLine line_{!request_.quiet};
    const std::vector<std::string> no_names_;
};

int run_result(const JobRequest& request) {
    const Interrupt interrupt;
    Collection(request, interrupt.token()).run();
    return 0;
}

void add_owner_option(Command& command, JobRequest& request) {
    command
        .add_option("--owner", request.server.options.owner,
                    "owner of the job, for operators, if several owners have a job with this id")
        .type_name("CLIENT");
}

void add_result_options(Command& command, JobRequest& request) {
    command.begin_section("Output");
    add_output_option(command, request.output, ".npy, .csv or .jsonl");
    const Option keep = command.add_flag("--keep", request.keep, "keep the job and its result on the server (default)");
    command
        .add_flag("--release", request.release,
                  "delete the job and its result from the server when the pairs are written")
        .excludes(keep);
    command.add_flag("--quiet", request.quiet, "no progress and no summary on standard error");
}

}  // namespace

void add_status(Command& program, Action& action) {
    Command command = program.add_subcommand("status", "show the state of jobs on a server");
    const auto request = std::make_shared<JobRequest>();
    command.begin_section("Job");
    const Option id = command.add_option("ID", request->id, "id of the job (default: all your jobs)");
    command
        .add_option(
            "--wait", [request](const std::string& text) { request->wait = parse_length("--wait", text); },
            "wait until the job has ended, at most this long")
        .type_name("SECONDS")
        .needs(id);
    command.add_flag("--json", request->json, "print JSON");
    add_owner_option(command, *request);
    add_server_address(command, request->server);
    command.set_examples({"octopair status --server unix:octopair/socket"});
    command.callback([request, id, &action] {
        check_server_named(request->server);
        if (id.is_given() && request->id.empty()) throw Error(ErrorCode::usage, "ID: must not be empty");
        action = [request] { return request->id.empty() ? run_list(*request) : run_status(*request); };
    });
}

void add_result(Command& program, Action& action) {
    Command command = program.add_subcommand("result", "write the pairs of a submitted job; wait until they are found");
    const auto request = std::make_shared<JobRequest>();
    command.begin_section("Job");
    command.add_option("ID", request->id, "id of the job").required();
    add_result_options(command, *request);
    add_server_address(command, request->server);
    command.set_examples({"octopair result ID --server HOST:PORT -o pairs.npy"});
    command.callback([request, &action] {
        check_server_named(request->server);
        if (request->output == "-") request->output.clear();
        if (!request->output.empty()) (void)io::pairs_format(request->output);
        action = [request] { return run_result(*request); };
    });
}

void add_cancel(Command& program, Action& action) {
    Command command = program.add_subcommand("cancel", "cancel a job on a server");
    const auto request = std::make_shared<JobRequest>();
    command.begin_section("Job");
    command.add_option("ID", request->id, "id of the job").required();
    command.add_flag("--release", request->release,
                     "delete the job and its result from the server when the job has ended");
    command.add_flag("--json", request->json, "print JSON");
    add_owner_option(command, *request);
    add_server_address(command, request->server);
    command.set_examples({"octopair cancel ID --server HOST:PORT"});
    command.callback([request, &action] {
        check_server_named(request->server);
        action = [request] { return run_cancel(*request); };
    });
}

void add_drain(Command& program, Action& action) {
    Command command = program.add_subcommand("drain", "end a server when its running jobs have ended; for operators");
    const auto server = std::make_shared<ServerChoice>();
    add_server_address(command, *server);
    command.set_examples({"octopair drain --server HOST:PORT"});
    command.callback([server, &action] {
        check_server_named(*server);
        action = [server] { return run_drain(*server); };
    });
}

}  // namespace octopair::cli
