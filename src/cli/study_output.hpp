// Where a study goes: tables to standard output, and JSON to a file if one is asked for.
#pragma once

#include <optional>
#include <stop_token>
#include <string>
#include <string_view>

#include "cli/command/progress_line.hpp"
#include "io/files/atomic_file.hpp"

namespace octopair::cli {

class StudyOutput {
public:
    /// `json`: a file, or empty. To be made before what takes long: it throws Error{io_failed} where there can be none.
    StudyOutput(const std::string& json, bool quiet) : progress_(!quiet) {
        if (!json.empty()) json_.emplace(json);
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
    ProgressLine progress_;
};

}  // namespace octopair::cli
