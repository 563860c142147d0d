#include "cli/command/file_options.hpp"

#include <fmt/format.h>

#include <filesystem>
#include <system_error>

#include "octopair/error.hpp"

namespace octopair::cli {

namespace {

namespace fs = std::filesystem;

/// Returns whether two paths are one regular file, or would be one after it is written. Errors are ignored: readers and writers
/// report invalid paths.
bool are_same_file(const fs::path& a, const fs::path& b) {
    std::error_code error;
    if (a.empty() || b.empty() || a == "-" || b == "-") return false;
    if (fs::exists(a, error) && fs::exists(b, error))
        return fs::equivalent(a, b, error) && fs::is_regular_file(a, error);
    return fs::weakly_canonical(fs::absolute(a, error), error) == fs::weakly_canonical(fs::absolute(b, error), error);
}

}  // namespace

void check_outputs(const std::vector<FileOption>& inputs, const std::vector<FileOption>& outputs) {
    for (auto output = outputs.begin(); output != outputs.end(); ++output) {
        for (const FileOption& input : inputs) {
            if (!are_same_file(output->path, input.path)) continue;
            const std::string what = input.option.empty() ? "an input" : fmt::format("the file of {}", input.option);
            throw Error(ErrorCode::usage,
                        fmt::format("{}: {} is also {}, which would be replaced", output->option, output->path, what));
        }
        for (auto earlier = outputs.begin(); earlier != output; ++earlier) {
            if (!are_same_file(output->path, earlier->path)) continue;
            throw Error(ErrorCode::usage,
                        fmt::format("{}: {} is also the file of {}", output->option, output->path, earlier->option));
        }
    }
}

}  // namespace octopair::cli
