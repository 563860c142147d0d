// Inputs that can be read only once: standard input ("-"), pipes, and sockets. Their content is copied into memory when they are
// opened first. Later openings of the same path get the copy.
#pragma once

#include <string>

#include "base/descriptor.hpp"

namespace octopair::io {

/// Returns whether `path` is "-", or exists and is a pipe, a socket or a terminal.
bool is_stream(const std::string& path);

/// Returns a descriptor of a file in memory with the content of a stream, read to its end. Each process reads a stream once.
/// Requires: is_stream(path).
/// Throws: Error{io_failed, resource_limit}.
/// Thread safety: any thread may call it. Blocks until the writer closes the stream.
Descriptor open_stream_copy(const std::string& path);

}  // namespace octopair::io
