// Checks the files that a command line names: no output may replace an input, or another output.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace octopair::cli {

/// A file of an option, for messages. An empty path means that the option is not given.
struct FileOption {
    std::string_view option;  ///< empty: the file is an argument
    std::string path;
};

/// Throws: Error{usage} if an output is the same regular file as an input or another output, also by another name or through a link.
void check_outputs(const std::vector<FileOption>& inputs, const std::vector<FileOption>& outputs);

}  // namespace octopair::cli
