// ReadBudget: limits the memory that a reader of octopair takes for a file, and stops the reader after a stop request.
//
// Readers call charge() before they allocate memory for content that the file describes. So a small file cannot fill the memory.
#pragma once

#include <cstdint>
#include <stop_token>
#include <string>

#include "io/files/failure.hpp"
#include "octopair/error.hpp"

namespace octopair::io {

class ReadBudget {
public:
    /// `path`: the file, for messages.
    ReadBudget(std::string path, const std::stop_token& stop) : path_(std::move(path)), stop_(stop) {}

    const std::string& path() const { return path_; }
    /// Counts bytes of files that were read. Each byte raises the limit.
    void add_file(std::uint64_t bytes) { file_bytes_ += bytes; }
    /// Returns the maximum number of bytes for the content of the files: 4 GiB, and 64 times the size of the files.
    std::uint64_t limit() const { return (std::uint64_t(4) << 30) + 64 * file_bytes_; }
    /// Counts memory for `count` values of `bytes` each. Throws: Error{resource_limit} if all counted memory is more than limit().
    void charge(std::uint64_t count, std::uint64_t bytes) {
        if (count > (limit() - charged_) / bytes) refuse_charge();
        charged_ += count * bytes;
    }
    /// Throws: Error{cancelled} after a stop request.
    void checkpoint() const {
        if (stop_.stop_requested()) cancel();
    }
    const std::stop_token& stop() const { return stop_; }

private:
    [[noreturn]] void refuse_charge() const {
        throw Error(ErrorCode::resource_limit, path_ + ": its content needs more than " + std::to_string(limit()) +
                                                   " bytes of memory, the limit for " + std::to_string(file_bytes_) +
                                                   " bytes of files");
    }

    std::string path_;
    std::stop_token stop_;
    std::uint64_t file_bytes_ = 0, charged_ = 0;
};

}  // namespace octopair::io
