// ByteSource: bytes that arrive one after the other, from a file or from a program.
#pragma once

#include <cstddef>
#include <functional>
#include <span>

namespace octopair::io {

/// Fills at least one byte of the span, and returns how many; 0 at the end of the bytes. May throw any Error.
using ByteSource = std::function<std::size_t(std::span<std::byte>)>;

}  // namespace octopair::io
