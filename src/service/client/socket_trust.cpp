#include "service/client/socket_trust.hpp"

#include <pwd.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <charconv>
#include <filesystem>
#include <system_error>
#include <vector>

#include "octopair/error.hpp"

namespace octopair::service {

namespace {

namespace fs = std::filesystem;

[[noreturn]] void refuse(const std::string& path, const std::string& why) {
    throw Error(ErrorCode::usage, "unix:" + path + ": the token is not sent, because " + why);
}

uid_t user_of(const std::string& name) {
    uid_t number = 0;
    const auto [end, error] = std::from_chars(name.data(), name.data() + name.size(), number);
    if (error == std::errc() && end == name.data() + name.size()) return number;
    const passwd* const known = ::getpwnam(name.c_str());  // only one thread makes connections of a program's options
    if (known == nullptr) throw Error(ErrorCode::usage, "no user has the name '" + name + "'");
    return known->pw_uid;
}

std::vector<uid_t> trusted_users(const std::string& server_user) {
    std::vector<uid_t> users = {::geteuid(), 0};
    if (!server_user.empty()) users.push_back(user_of(server_user));
    return users;
}

}  // namespace

void check_socket_trust(const std::string& path, const std::string& server_user) {
    const std::vector<uid_t> users = trusted_users(server_user);
    const auto is_trusted = [&](const struct stat& found) {
        return std::find(users.begin(), users.end(), found.st_uid) != users.end();
    };
    std::error_code error;
    const fs::path socket = fs::weakly_canonical(fs::absolute(path, error), error);
    struct stat found {};
    if (::lstat(socket.c_str(), &found) == 0 && !is_trusted(found)) refuse(path, "another user listens there");
    for (fs::path folder = socket.parent_path();; folder = folder.parent_path()) {
        if (::stat(folder.c_str(), &found) != 0) refuse(path, "the folder " + folder.string() + " cannot be examined");
        if (!is_trusted(found)) refuse(path, "the folder " + folder.string() + " belongs to another user");
        const bool open = (found.st_mode & (S_IWGRP | S_IWOTH)) != 0;
        const bool keeps_entries = (found.st_mode & S_ISVTX) != 0 && folder != socket.parent_path();
        if (open && !keeps_entries)
            refuse(path, "other users can write to " + folder.string() + "; use a folder of your own");
        if (folder == folder.root_path()) return;
    }
}

}  // namespace octopair::service
