// Options of `octopair view`.
#include "cli/view/view.hpp"

#include <fmt/format.h>
#include <sys/random.h>

#include <algorithm>
#include <array>

#include "cli/command/option_values.hpp"
#include "cli/detect/detect_options.hpp"
#include "cli/server/server_choice.hpp"
#include "io/formats/format_choice.hpp"
#include "io/results/result_file.hpp"
#include "octopair/error.hpp"

namespace octopair::cli {

namespace {

[[noreturn]] void refuse_view(const std::string& what) { throw Error(ErrorCode::usage, what); }

/// Adds the inputs and the options of the search, which are those of `octopair detect`.
void add_search_options(Command& command, ViewRequest& request) {
    DetectRequest& detect = request.detect;
    add_scene_options(command, detect,
                      "scene files, a recording, a result (also with its scene), or the address of a server");
    add_stage_options(command, detect.pipeline,
                      "last stage: pairs, objects or features (default: features for mesh and JSON files)");
    command.begin_section("Exact stages");
    add_exact_options(command, detect.pipeline);
    request.search_options = command.option_names();
}

void add_output_options(Command& command, ViewRequest& request) {
    command.begin_section("Output");
    command.add_option("--export", request.export_page, "write the page with its data as one file, and do not serve it")
        .type_name("PAGE.html");
    command
        .add_option("--screenshot", request.screenshot, "write a picture of the first view, and do not serve the page")
        .type_name("PICTURE.png");
    command.add_flag("--quiet", request.detect.quiet, "no progress and no summary on standard error");
}

void add_page_options(Command& command, ViewRequest& request) {
    command.begin_section("Page");
    add_up_option(command, request.detect.pipeline, "axis that points up: y or z (default: that of the file, or z)");
    add_unit_option(command, request.detect.pipeline,
                    "unit of lengths: um, mm, cm, dm, m, km, in or ft (default: that of the file)");
    command
        .add_option(
            "--port",
            [&request](const std::string& text) { request.port = unsigned(parse_count("--port", text, 65535)); },
            "port of the page on this machine (default 0: any that is free)")
        .type_name("N");
    command.add_option("--listen", request.listen, "serve other machines, too, at this numeric address; makes a token")
        .type_name("HOST:PORT");
    command.add_flag("--no-browser", request.no_browser, "only print the address of the page");
}

void add_threads_option(Command& command, EngineChoice& choice) {
    command.begin_section("Engine");
    command
        .add_option(
            "--threads", [&choice](const std::string& text) { choice.threads = parse_threads(text); },
            "threads of the search (default 0: one per core)")
        .type_name("N");
}

bool is_address(const std::string& input) {
    if (input.starts_with("unix:")) return true;
    const std::size_t colon = input.rfind(':');
    return colon != std::string::npos && colon > 0 && colon + 1 < input.size() &&
           input.find('/') == std::string::npos &&
           input.find_first_not_of("0123456789", colon + 1) == std::string::npos;
}

/// Throws: Error{usage} if options of a search are given. `input`: the input, for the message; showing it needs no search.
void check_no_search(const ViewRequest& request, const std::string& input) {
    const auto& names = request.search_options;
    for (const GivenOption& option : request.detect.given) {
        const std::string_view name = option.name;
        if (!name.starts_with("--")) continue;
        if (std::find(names.begin(), names.end(), name.substr(2)) == names.end()) continue;
        refuse_view(fmt::format("{}: not with {}, whose pairs are known", name, input));
    }
}

void check_server_view(ViewRequest& request) {
    DetectRequest& detect = request.detect;
    if (detect.inputs.size() > 1) refuse_view("a server is shown alone, without other inputs");
    check_no_search(request, "a server");
    if (!request.export_page.empty() || !request.screenshot.empty())
        refuse_view("--export and --screenshot: not with a server");
    if (detect.pipeline.space.up != io::UpAxis::unknown) refuse_view("--up: not with a server");
    if (!detect.pipeline.space.unit.empty()) refuse_view("--unit: not with a server");
#ifdef OCTOPAIR_WITH_SERVICE
    detect.engine.choose_server(detect.inputs.front());
    detect.inputs.clear();
#else
    refuse_view(detect.inputs.front() + " is the address of a server; this octopair was built without servers");
#endif
}

void set_stage(DetectRequest& request) {
    // If the inputs have shapes and --stage is not given, run the stage `features`, because the page shows contacts.
    if (!request.pipeline.stage && stage_of(request) == Stage::objects) request.pipeline.stage = Stage::features;
}

/// Moves the result file among the inputs, if any, to request.result.
void find_result(ViewRequest& request) {
    std::vector<std::string> scenes;
    for (const std::string& input : request.detect.inputs) {
        if (!io::is_result(input)) {
            scenes.push_back(input);
        } else if (request.result.empty()) {
            request.result = input;
        } else {
            refuse_view(fmt::format("{}: {} is a result, too; only one is shown", input, request.result));
        }
    }
    request.detect.inputs = std::move(scenes);
}

/// Checks the options for scenes and results, and sets the last stage of the search.
void check_scenes(ViewRequest& request) {
    DetectRequest& detect = request.detect;
    if (!request.result.empty()) {
        check_no_search(request, "a result");
        detect.pipeline.stage = Stage::pairs;
        return;
    }
    const auto recording = std::find_if(detect.inputs.begin(), detect.inputs.end(), is_recording);
    if (recording != detect.inputs.end()) {
        if (detect.inputs.size() > 1) refuse_view(*recording + ": a recording is shown alone, without other inputs");
        check_no_search(request, "a recording");
        detect.pipeline.stage = Stage::pairs;
        return;
    }
    set_stage(detect);
    check_search_options(detect);
}

std::string random_token() {
    std::array<unsigned char, 16> bytes;
    if (::getrandom(bytes.data(), bytes.size(), 0) != ssize_t(bytes.size())) {
        throw Error(ErrorCode::io_failed, "the system has no random numbers");
    }
    std::string token;
    for (const unsigned char byte : bytes) token += fmt::format("{:02x}", byte);
    return token;
}

}  // namespace

void add_view_options(Command& command, ViewRequest& request) {
    add_search_options(command, request);
    add_output_options(command, request);
    add_page_options(command, request);
    add_threads_option(command, request.detect.engine);
#ifdef OCTOPAIR_WITH_SERVICE
    add_server_options(command, request.detect.engine.server);
#endif
}

void check_view_options(ViewRequest& request) {
    DetectRequest& detect = request.detect;
    if (std::any_of(detect.inputs.begin(), detect.inputs.end(), is_address)) return check_server_view(request);
#ifdef OCTOPAIR_WITH_SERVICE
    check_server_choice(detect.engine.server);
#endif
    const std::string ending = io::ending_of(request.export_page);
    if (!request.export_page.empty() && ending != ".html" && ending != ".htm") {
        refuse_view(fmt::format("--export: {}: the name of a page must end in .html or .htm", request.export_page));
    }
    if (!request.screenshot.empty() && io::ending_of(request.screenshot) != ".png") {
        refuse_view(fmt::format("--screenshot: {}: the name of a picture must end in .png", request.screenshot));
    }
    std::vector<FileOption> inputs;
    inputs.reserve(detect.inputs.size() + 3);
    for (const std::string& input : detect.inputs) inputs.push_back({"", input});
    inputs.push_back({"--against", detect.against});
    inputs.push_back({"--padding", detect.padding});
    inputs.push_back({"--exclude", detect.pipeline.exclude});
    check_outputs(inputs, {{"--export", request.export_page}, {"--screenshot", request.screenshot}});
    find_result(request);
    check_scenes(request);
    if (request.export_page.empty() && request.screenshot.empty()) {
        (void)server_options(request);
    } else if (request.port != 0 || !request.listen.empty()) {
        refuse_view("--port and --listen: not with --export and --screenshot, which serve no page");
    }
}

viewer::PageServerOptions server_options(const ViewRequest& request) {
    viewer::PageServerOptions options;
    options.port = std::uint16_t(request.port);
    if (request.listen.empty()) return options;
    if (request.port != 0) refuse_view("--port: not with --listen, which has a port");
    const std::size_t colon = request.listen.rfind(':');
    if (colon == std::string::npos || colon == 0) {
        refuse_view(fmt::format("--listen: {} is not HOST:PORT, for example 0.0.0.0:8080", request.listen));
    }
    options.port = std::uint16_t(parse_count("--listen", request.listen.substr(colon + 1), 65535));
    options.host = request.listen.substr(0, colon);
    if (options.host.starts_with('[') && options.host.ends_with(']')) {
        options.host = options.host.substr(1, options.host.size() - 2);
    }
    options.token = random_token();
    return options;
}

}  // namespace octopair::cli
