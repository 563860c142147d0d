#include "service/server_process.hpp"

#include <fcntl.h>
#include <spawn.h>
#include <stdlib.h>  // NOLINT(modernize-deprecated-headers): mkdtemp
#include <sys/wait.h>

#include <cerrno>
#include <csignal>
#include <system_error>

#include "base/descriptor.hpp"

extern char** environ;

namespace octopair::bench {

namespace {

std::filesystem::path new_folder() {
    std::string name = (std::filesystem::temp_directory_path() / "octopair-XXXXXX").string();
    if (::mkdtemp(name.data()) == nullptr) fail_io(name, "cannot make a folder", errno);
    return name;
}

}  // namespace

ServerProcess::ServerProcess(const std::string& program, const std::vector<std::string>& options)
    : folder_(new_folder()) {
    std::vector<std::string> words = {program, "serve", "--listen", address()};
    words.insert(words.end(), options.begin(), options.end());
    std::vector<char*> pointers;
    pointers.reserve(words.size() + 1);
    for (std::string& word : words) pointers.push_back(word.data());
    pointers.push_back(nullptr);
    posix_spawn_file_actions_t actions{};
    ::posix_spawn_file_actions_init(&actions);
    ::posix_spawn_file_actions_addopen(&actions, STDERR_FILENO, (folder_ / "log").c_str(), O_WRONLY | O_CREAT, 0600);
    const int refused = ::posix_spawn(&process_, program.c_str(), &actions, nullptr, pointers.data(), environ);
    ::posix_spawn_file_actions_destroy(&actions);
    if (refused != 0) fail_io(program, "cannot run", refused);
}

ServerProcess::~ServerProcess() {
    ::kill(process_, SIGTERM);
    ::waitpid(process_, nullptr, 0);
    std::error_code ignored;
    std::filesystem::remove_all(folder_, ignored);
}

}  // namespace octopair::bench
