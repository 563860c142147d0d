// octopair submit: sends a scene to a server as a detached job.
#include <memory>
#include <optional>

#include "cli/command/interrupt.hpp"
#include "cli/command/progress_line.hpp"
#include "cli/detect/detect_options.hpp"
#include "cli/input/input_set.hpp"
#include "cli/input/search_inputs.hpp"
#include "cli/server/server_choice.hpp"
#include "cli/subcommands.hpp"
#include "io/files/output_stream.hpp"
#include "octopair/error.hpp"
#include "octopair/job_client.hpp"
#ifdef OCTOPAIR_WITH_PIPELINE
#include "cli/input/shaped_set.hpp"
#endif

namespace octopair::cli {

namespace {

struct SubmitRequest {
    DetectRequest what;
    ServerChoice server;
    std::string id;
};

InputSet read_still_set(const std::vector<std::string>& paths, const io::SceneContent& content,
                        const std::stop_token& stop) {
    InputSet set = read_input_set(paths, content, stop);
    if (set.scene.moving)
        throw Error(ErrorCode::usage, paths.front() + ": the scene moves; a job can have only one frame");
    return set;
}

/// Removes a job if the server still answers.
void remove_job(JobClient& client, const std::string& id) {
    try {
        (void)client.cancel(id);
        client.release(id);
    } catch (const Error&) {
    }
}

std::string submit(const SubmitRequest& request, const std::stop_token& stop) {
    const DetectRequest& what = request.what;
    ProgressLine progress(!what.quiet);
    JobClient client(request.server.address, client_options(request.server));
    io::SceneContent content{.objects = what.mesh_objects, .reader = reader_of(what)};
    InputSet inputs = read_still_set(what.inputs, content, stop), against;
    content.unit = inputs.scene.space.unit;
    if (!what.against.empty()) against = read_still_set({what.against}, content, stop);
#ifdef OCTOPAIR_WITH_PIPELINE
    make_shaped(inputs, against, {}, stop);
#endif
    const Paddings padding(what, {inputs.scene.objects, against.scene.objects}, stop);
    if (!what.padding.empty()) {
        inputs.padding = padding.inputs();
        against.padding = padding.against();
    }
    for (const InputSet* set : {&inputs, &against}) {
        if (const auto invalid = set->find_invalid_box()) throw Error(ErrorCode::bad_input, invalid->message);
    }
    Options options;
    options.order = what.order;
    options.margin = what.margin;
    options.limit = what.limit;
    options.progress = [&progress](double done) { progress.show("sending", done); };
    const JobTerms terms = {request.id, what.count_only};
    const Input input(inputs.frame(0), what.against.empty() ? std::nullopt : std::optional(against.frame(0)));
    std::string id = client.submit(input, options, terms, stop);
    try {
        for (const InputSet* set : {&inputs, &against}) set->scene.check_mapped();
    } catch (const Error& error) {
        // With --id, the job may have existed before this command. So do not remove the job.
        if (!request.id.empty())
            throw Error(error.code(), std::string(error.what()) + "; job " + id + " may have some of the new numbers");
        remove_job(client, id);
        throw;
    }
    return id;
}

int run_submit(const SubmitRequest& request) {
    const Interrupt interrupt;
    const std::string id = submit(request, interrupt.token());
    io::StandardOutput out(interrupt.token());
    out.write(id + '\n');
    out.commit();
    return 0;
}

}  // namespace

void add_submit(Command& program, Action& action) {
    Command command = program.add_subcommand("submit", "send a scene to a server, and collect its pairs later");
    const auto request = std::make_shared<SubmitRequest>();
    add_scene_options(command, request->what, ".npy, .csv, .json or mesh files; several files form one set");
    command.begin_section("Output");
    add_order_options(command, request->what, "find only the first N pairs");
    command.add_flag("--count-only", request->what.count_only, "find only the number of pairs");
    command.add_flag("--quiet", request->what.quiet, "no progress on standard error");
    command.begin_section("Server");
    command
        .add_option("--id", request->id, "id of the job; the same id again means the same job (default: a random id)")
        .type_name("UUID");
    add_server_address(command, request->server);
    command.set_examples({"octopair submit boxes.npy --server unix:octopair/socket"});
    command.callback([request, &action] {
        check_server_named(request->server);
        action = [request] { return run_submit(*request); };
    });
}

}  // namespace octopair::cli
