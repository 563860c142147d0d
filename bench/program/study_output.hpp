// StudyOutput: writes the tables of a study to standard output, and its JSON to a file.
#pragma once

#include <optional>
#include <stop_token>
#include <string>
#include <string_view>

#include "cli/command/command.hpp"
#include "cli/command/progress_line.hpp"
#include "io/files/atomic_file.hpp"

namespace octopair::bench {

/// Options of the output.
struct OutputRequest {
    std::string json;  ///< path of a file, or empty
    bool quiet = false;
};

/// Adds --json and --quiet. `what`: describes the JSON.
inline void add_output_options(cli::Command& command, OutputRequest& request, const std::string& what) {
    command.add_option("--json", request.json, what).type_name("FILE");
    command.add_flag("--quiet", request.quiet, "print no progress on standard error");
}

class StudyOutput {
public:
    /// Opens the file. Construct before the measurements, so that an unwritable file fails early. Throws: Error{io_failed}.
    explicit StudyOutput(const OutputRequest& request) : progress_(!request.quiet) {
        if (!request.json.empty()) json_.emplace(request.json);
    }

    void show(std::string_view activity, double done) { progress_.show(activity, done); }
    void write(const std::string& text, const std::string& json, const std::stop_token& stop) {
        progress_.clear();
        io::StandardOutput out(stop);
        out.write(text);
        out.commit();
        if (!json_) return;
        json_->write(json);
        json_->commit();
    }

private:
    std::optional<io::AtomicFile> json_;
    cli::ProgressLine progress_;
};

}  // namespace octopair::bench
