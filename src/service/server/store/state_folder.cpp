#include "service/server/store/state_folder.hpp"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <sys/statvfs.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <cstdio>
#include <filesystem>
#include <limits>
#include <span>
#include <string_view>
#include <utility>

#include "base/descriptor.hpp"
#include "octopair/error.hpp"
#include "service/server/log/log_line.hpp"
#include "service/server/store/file.hpp"

namespace octopair::service {

namespace {

namespace fs = std::filesystem;

constexpr std::size_t digits = 16;

/// Returns the number N of a file name "N" + `ending`, or nothing for another name.
std::optional<std::uint64_t> number_of(const std::string& name, std::string_view ending) {
    if (name.size() != digits + ending.size() || name.substr(digits) != ending) return {};
    if (name.find_first_not_of("0123456789abcdef") < digits) return {};
    return std::stoull(name.substr(0, digits), nullptr, 16);
}

FileBytes bytes_of(const File& file) {
    return {file.name(), file.size(),
            [&file](std::uint64_t offset, std::span<std::byte> bytes) { file.read(offset, bytes); }};
}

}  // namespace

StateFolder::StateFolder(std::string path, const Room& room, std::shared_ptr<spdlog::logger> log)
    : path_(std::move(path)),
      log_(std::move(log)),
      disk_("state_bytes", "bytes of state on its disk", room.total, room.per_client) {
    const bool made = ::mkdir(path_.c_str(), 0700) == 0;
    if (!made && errno != EEXIST) fail_io(path_, "cannot create", errno);
    if (made && !sync_folder_of(path_)) fail_io(path_, "cannot sync its folder", errno);
    const Descriptor folder(::open(path_.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC));
    if (!folder.open()) fail_io(path_, "cannot open", errno);
    struct stat status {};
    if (::fstat(folder.number(), &status) != 0) fail_io(path_, "cannot open", errno);
    if ((status.st_mode & 077) != 0) {
        throw Error(ErrorCode::usage, path_ + ": other users may access the state folder; make it private (chmod 700)");
    }
    lock();
    check_version();
}

StateFolder::DiskSpace StateFolder::disk_space() const {
    constexpr std::uint64_t unknown = std::numeric_limits<std::uint64_t>::max();
    struct statvfs status {};
    if (::statvfs(path_.c_str(), &status) != 0 || status.f_blocks == 0) return {unknown, unknown};
    return {std::uint64_t(status.f_blocks) * status.f_frsize, std::uint64_t(status.f_bavail) * status.f_frsize};
}

void StateFolder::lock() {
    const std::string path = path_ + "/lock";
    lock_ = Descriptor(::open(path.c_str(), O_RDWR | O_CREAT | O_CLOEXEC | O_NOFOLLOW, 0600));
    if (!lock_.open()) fail_io(path, "cannot open", errno);
    if (::flock(lock_.number(), LOCK_EX | LOCK_NB) == 0) return;
    if (errno == EWOULDBLOCK) throw Error(ErrorCode::io_failed, path_ + ": another server uses this state folder");
    fail_io(path, "cannot lock", errno);
}

/// Throws if the folder has a newer version than this program. Otherwise writes the current version to the file `version`. Only this
/// file differs between versions 1 and 2: version 1 has none.
void StateFolder::check_version() const {
    constexpr std::uint64_t newest = 2;
    constexpr std::string_view before = "octopair state ";
    const std::string path = path_ + "/version", part = path + ".part";
    if (fs::exists(path)) {
        const File file(path, File::Mode::read);
        std::string text(std::size_t(std::min<std::uint64_t>(file.size(), 64)), '\0');
        file.read(0, std::as_writable_bytes(std::span(text)));
        std::uint64_t version = 0;
        const char* const end = text.data() + text.size();
        const bool valid = text.starts_with(before) && text.ends_with('\n') &&
                           std::from_chars(text.data() + before.size(), end, version).ptr == end - 1 && version > 0;
        if (!valid) throw Error(ErrorCode::io_failed, path + ": damaged: it is not a version of a state folder");
        if (version > newest) {
            throw Error(ErrorCode::io_failed, path_ + ": the state folder has version " + std::to_string(version) +
                                                  "; this program uses version " + std::to_string(newest) +
                                                  " or older. Nothing was changed");
        }
        if (version == newest) return;
    }
    remove_file(part);
    const File fresh(part, File::Mode::create);
    const std::string text = std::string(before) + std::to_string(newest) + "\n";
    fresh.write(0, std::as_bytes(std::span(text)));
    fresh.finish(path);
}

std::string StateFolder::base_of(std::uint64_t number) const {
    char name[digits + 1];
    (void)std::snprintf(name, sizeof name, "%016llx", static_cast<unsigned long long>(number));
    return path_ + "/" + name;
}

std::string StateFolder::new_base() { return base_of(++last_); }

/// Removes incomplete files, and results without a job. Returns the numbers of the jobs, ascending.
std::vector<std::uint64_t> StateFolder::clean_up() {
    std::vector<std::uint64_t> jobs, results;
    std::error_code error;
    for (fs::directory_iterator at(path_, error), end; !error && at != end; at.increment(error)) {
        const std::string name = at->path().filename().string();
        if (const auto job = number_of(name, ".job")) jobs.push_back(*job);
        if (const auto result = number_of(name, ".result")) results.push_back(*result);
        const bool part = number_of(name, ".job.part") || number_of(name, ".result.part");
        if (part && remove_file(at->path().string())) log_text(*log_, LogLevel::info, name + ": incomplete; removed");
    }
    if (error) fail_io(path_, "cannot read", error.value());
    std::sort(jobs.begin(), jobs.end());
    for (const std::uint64_t result : results) {
        last_ = std::max<std::uint64_t>(last_, result);
        if (!std::binary_search(jobs.begin(), jobs.end(), result)) remove_file(base_of(result) + ".result");
    }
    if (!jobs.empty()) last_ = std::max<std::uint64_t>(last_, jobs.back());
    return jobs;
}

std::vector<StateFolder::Found> StateFolder::find_jobs() {
    std::vector<Found> found;
    for (const std::uint64_t number : clean_up()) {
        if (auto job = find_job(base_of(number))) found.push_back(std::move(*job));
    }
    return found;
}

std::optional<StateFolder::Found> StateFolder::find_job(const std::string& base) {
    try {
        const File file(base + ".job", File::Mode::read);
        Found found;
        found.base = base;
        found.stored = read_job(bytes_of(file));
        found.disk = disk_.take_unchecked(file.size() + overhead_bytes, found.stored.owner);
        if (found.stored.hash.empty()) {
            found.damage = Error(ErrorCode::io_failed, file.name() + ": damaged: the end of the file is invalid");
        }
        find_result(found);
        return found;
    } catch (const Error& error) {
        log_text(*log_, LogLevel::error, path_ + "/" + error.what() + "; the file is skipped and kept");
        return {};
    }
}

void StateFolder::find_result(Found& found) {
    const std::string path = found.base + ".result";
    if (!fs::exists(path)) return;
    try {
        const File file(path, File::Mode::read);
        found.result_disk = disk_.take_unchecked(file.size(), found.stored.owner);
        found.result = read_result(bytes_of(file));
        if (found.result->hash != found.stored.hash && !found.damage) {
            fail_damaged(file.name(), "it is the result of another job");
        }
    } catch (const Error& error) {
        found.result.reset();
        found.damage = error;
    }
}

}  // namespace octopair::service
