// Temporary file that receives the results of a child program. The destructor removes the file.
#pragma once

#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>

#include "base/descriptor.hpp"
#include "octopair/error.hpp"

namespace octopair::cluster {

class TemporaryFile {
public:
    TemporaryFile() : path_((std::filesystem::temp_directory_path() / "octopair-bench-XXXXXX").string()) {
        const Descriptor file(::mkstemp(path_.data()));
        if (!file.open()) throw Error(ErrorCode::io_failed, path_ + ": cannot create");
    }
    TemporaryFile(const TemporaryFile&) = delete;
    TemporaryFile& operator=(const TemporaryFile&) = delete;
    ~TemporaryFile() { ::unlink(path_.c_str()); }

    const std::string& path() const { return path_; }
    std::string content() const {
        std::ifstream in(path_);
        std::ostringstream text;
        text << in.rdbuf();
        return text.str();
    }

private:
    std::string path_;
};

}  // namespace octopair::cluster
