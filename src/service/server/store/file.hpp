// File: a file of the state folder. A failed system call becomes an Error that names the file.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>

#include "base/descriptor.hpp"

namespace octopair::service {

/// Returns the last part of a path.
std::string name_of_file(const std::string& path);

/// Throws: Error{io_failed} from all members; NoRoomError if the disk is full. Messages name the file without its folder, because
/// clients receive them. Thread safety: read() and write() are safe, as each takes its offset.
class File {
public:
    enum class Mode : std::uint8_t { read, create };

    File() = default;
    /// `create`: the file must not exist yet; only its owner may access it.
    File(std::string path, Mode mode);

    bool open() const { return descriptor_.open(); }
    const std::string& path() const { return path_; }
    /// Returns the name without the folder.
    std::string name() const { return name_of_file(path_); }
    std::uint64_t size() const;
    void read(std::uint64_t offset, std::span<std::byte> bytes) const;
    void write(std::uint64_t offset, std::span<const std::byte> bytes) const;
    /// Allocates disk space for a file of `bytes` bytes, so that a full disk is reported early. Does nothing on file systems
    /// without fallocate.
    void reserve(std::uint64_t bytes) const;
    /// Syncs the file, renames it to `path` in the same folder, and syncs the folder.
    void finish(const std::string& path) const;

private:
    std::string path_;
    Descriptor descriptor_;
};

/// Returns whether the file existed and was removed.
bool remove_file(const std::string& path) noexcept;
/// Syncs the folder that contains `path`, so that created, renamed and removed files persist. Returns false, with errno set, on
/// failure. A file system that cannot sync folders is no failure.
bool sync_folder_of(const std::string& path) noexcept;

}  // namespace octopair::service
