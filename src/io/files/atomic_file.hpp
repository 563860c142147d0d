// A result file that appears whole or not at all.
//
// It is written to a temporary file in the directory of its path: without a name where the system offers that
// (O_TMPFILE), so that even a killed program leaves nothing, else under a name of its own. commit() syncs it, renames
// it onto the path and syncs the directory; destroyed without commit(), it is removed and what was at the path stays as
// it was. A symbolic link at the path is followed. Several processes can write one: those that did not make it, its parts.
#pragma once

#include <cstdint>
#include <string>

#include "base/descriptor.hpp"
#include "io/files/output_stream.hpp"

namespace octopair::io {

class AtomicFile final : public OutputStream {
public:
    /// Throws Error{io_failed} if no file can be made in the directory, or if something other than a regular file is at
    /// the path.
    explicit AtomicFile(const std::string& path);
    /// The same with a temporary file that others can open by its name.
    struct Shared {};
    AtomicFile(const std::string& path, Shared);
    ~AtomicFile() override;

    const std::string& path() const { return path_; }
    /// While it is not committed: its name, of one that is shared.
    const std::string& temporary() const { return temporary_; }
    /// Replaces bytes that were written already.
    void write_at(std::uint64_t offset, std::string_view text);

private:
    void choose_place(const std::string& path);
    void put(std::span<const std::byte> bytes) override;
    void finish() override;
    void write_all(std::span<const std::byte> bytes, std::uint64_t offset);
    void open_unnamed();
    void open_named();
    void give_name();
    void remove_temporary() noexcept;

    std::string path_;
    std::string directory_;
    std::string temporary_;  // its name while it has one
    Descriptor descriptor_;
    std::uint64_t end_ = 0;
};

/// Part of a shared file that another process made. What is written is final with sync().
class FilePart {
public:
    /// `temporary` of the one that made it, `path` for messages. Throws Error{io_failed}, as the others do.
    FilePart(const std::string& temporary, const std::string& path);

    void write_at(std::uint64_t offset, std::span<const std::byte> bytes);
    void sync();

private:
    std::string path_;
    Descriptor descriptor_;
};

}  // namespace octopair::io
