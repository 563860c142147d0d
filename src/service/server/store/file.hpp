// A file of the state folder: what the system refuses is an Error that names it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>

#include "base/descriptor.hpp"

namespace octopair::service {

/// Reads and writes are at given places, and may come from several threads. All throw Error{io_failed}.
class File {
public:
    enum class Mode : std::uint8_t { read, create };

    File() = default;
    /// `create`: it must not be there; nobody else may read it.
    File(std::string path, Mode mode);

    bool open() const { return descriptor_.open(); }
    const std::string& path() const { return path_; }
    std::uint64_t size() const;
    void read(std::uint64_t offset, std::span<std::byte> bytes) const;
    void write(std::uint64_t offset, std::span<const std::byte> bytes) const;
    /// Room for `bytes` in all, where the file system can set it aside: so want of it is known before the work.
    void reserve(std::uint64_t bytes) const;
    /// Syncs the file, renames it to `path` in its folder, and syncs that.
    void finish(const std::string& path) const;

private:
    std::string path_;
    Descriptor descriptor_;
};

/// Whether it was there.
bool remove_file(const std::string& path) noexcept;
/// What was created, renamed or removed in it lasts. Some file systems cannot; that is passed over. False, with errno, if it
/// fails.
bool sync_folder_of(const std::string& path) noexcept;

}  // namespace octopair::service
