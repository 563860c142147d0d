// AtomicFile: a result file that appears whole or not at all.
//
// - The bytes go to a temporary file in the directory of the path.
// - The temporary file has no name where the system supports O_TMPFILE. Then even a killed program leaves no file behind.
//   Elsewhere, and for shared files, it has a random name.
// - commit() syncs the temporary file, renames it to the path, and syncs the directory.
// - Without commit(), the destructor removes the temporary file, and the file at the path stays unchanged.
// - A symbolic link at the path is followed. A file that is replaced keeps its mode and, where the system allows it, its owner.
// - If the path is "-" (standard output), a pipe or a device, the temporary file is in memory. commit() copies it there.
// - Several processes can write one shared file: its maker through AtomicFile, the others through FilePart.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "base/descriptor.hpp"
#include "io/files/output_stream.hpp"

namespace octopair::io {

/// Bytes that a file can have.
struct FileRoom {
    std::uint64_t bytes;
    const char* what;  ///< end of a message about the bytes: what bounds them
};

/// Returns how many bytes the temporary file of an AtomicFile for `path` can get, by the free space of its file system and RLIMIT_FSIZE;
/// for a stream, by the free memory. Returns nothing if that is unknown, as on file systems that can compress files.
std::optional<FileRoom> room_for_file(const std::string& path);

class AtomicFile final : public OutputStream {
public:
    /// Throws: Error{io_failed} if no file can be created in the directory, or if the path is a directory.
    explicit AtomicFile(const std::string& path);
    /// Makes a shared file: other processes can open its temporary file by name. The path must not be a stream.
    struct Shared {};
    AtomicFile(const std::string& path, Shared);
    ~AtomicFile() override;

    const std::string& path() const { return path_; }
    /// Returns the path of the temporary file. Requires: the file is shared and not committed.
    const std::string& temporary() const { return temporary_; }
    /// Overwrites bytes that were written before.
    void write_at(std::uint64_t offset, std::string_view text);

private:
    void choose_place(const std::string& path);
    void keep_attributes() const;
    void copy_to_stream();
    void put(std::span<const std::byte> bytes) override;
    void finish() override;
    void write_all(std::span<const std::byte> bytes, std::uint64_t offset);
    void open_unnamed();
    void open_named();
    void give_name();
    void remove_temporary() noexcept;

    std::string path_;
    std::string directory_;
    std::string temporary_;  // path of the temporary file, or empty if it has no name
    Descriptor descriptor_;
    Descriptor stream_;  // open if the path is a stream; descriptor_ is then in memory
    std::uint64_t end_ = 0;
};

/// Access to a shared file that another process made. The caller must sync() before that process commits the file.
class FilePart {
public:
    /// `temporary` is AtomicFile::temporary() of the maker. Messages begin with `path`.
    /// Throws: Error{io_failed}, as all members do.
    FilePart(const std::string& temporary, const std::string& path);

    void write_at(std::uint64_t offset, std::span<const std::byte> bytes);
    void sync();

private:
    std::string path_;
    Descriptor descriptor_;
};

}  // namespace octopair::io
