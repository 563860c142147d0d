#include "engine/processes/client/worker_program.hpp"

#include <dlfcn.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <system_error>
#include <vector>

#include "octopair/error.hpp"

namespace octopair {

namespace {

namespace fs = std::filesystem;

/// Returns the path of the file that contains this code: a library, or the program. Empty if unknown.
fs::path own_file() {
    Dl_info info = {};
    if (dladdr(reinterpret_cast<const void*>(&find_worker_program), &info) == 0 || info.dli_fname == nullptr) return {};
    return info.dli_fname;
}

std::vector<std::string> candidate_paths(const std::string& packaged) {
    std::vector<std::string> found;
    std::error_code error;
    const fs::path self = fs::read_symlink("/proc/self/exe", error);
    if (!error) {
        const fs::path folder = self.parent_path();
        found.push_back(folder / "octopair-worker");
        found.push_back(folder.parent_path() / OCTOPAIR_WORKER_FOLDER / "octopair-worker");
    }
    if (const fs::path library = own_file(); library.is_absolute())
        found.push_back((library.parent_path() / OCTOPAIR_WORKER_FROM_LIBRARY / "octopair-worker").lexically_normal());
    if (!packaged.empty()) found.push_back(packaged);
    // A build tree uses its own program, not that of an older installation. Builds for packages leave out paths that they cannot know.
    for (const std::string configured : {OCTOPAIR_WORKER_BUILT, OCTOPAIR_WORKER_INSTALLED}) {
        if (!configured.empty()) found.push_back(configured);
    }
    return found;
}

}  // namespace

std::string find_worker_program(const std::string& requested, const std::string& packaged) {
    if (!requested.empty()) return requested;
    const char* const named = std::getenv("OCTOPAIR_WORKER");
    if (named != nullptr && *named != 0) return named;
    std::string tried;
    for (const std::string& path : candidate_paths(packaged)) {
        if (::access(path.c_str(), X_OK) == 0) return path;
        tried += (tried.empty() ? "" : ", ") + path;
    }
    throw Error(ErrorCode::engine_failed,
                "cannot find the worker program; set OCTOPAIR_WORKER to its path; tried " + tried);
}

}  // namespace octopair
