// Parses and makes the header of NumPy .npy files, format versions 1.0, 2.0 and 3.0.
//
//   bytes 0..5   0x93 'N' 'U' 'M' 'P' 'Y'        6, 7  version: major, minor (0)
//   8..9 (1.0) or 8..11 (2.0, 3.0)               length of the text that follows, little endian
//   text         a Python dict literal of exactly the keys 'descr', 'fortran_order', 'shape', then spaces, then '\n'
//   data         right after the text, to the end of the file
//
// Accepted: float32 and float64 in either byte order, in C or Fortran order; little endian uint32 and uint64 in C order; a file of
// exactly the length that the shape needs. Lengths of the shape may end with L, as Python 2 writes them.
// For everything else, the error says what was found.
//
// Source: NumPy enhancement proposal 1 and numpy.lib.format.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace octopair::io {

enum class NpyType : std::uint8_t { float32, float64, uint32, uint64 };

std::size_t item_bytes(NpyType type);
/// Returns the type as NumPy writes it, for example "<f4".
std::string_view type_text(NpyType type);

struct NpyHeader {
    NpyType type = NpyType::float32;
    std::vector<std::uint64_t> shape;
    std::uint64_t data_offset = 0;
    bool fortran_order = false;  ///< the first index of an element changes fastest, not the last
    bool big_endian = false;
};

/// Returns the shape as Python writes it: "(3, 6)", "(3,)", "()".
std::string shape_text(std::span<const std::uint64_t> shape);

/// Maximum length of a header. parse_npy_header() never needs more bytes than this from the beginning of a file.
inline constexpr std::size_t npy_header_max_bytes = std::size_t(64) << 10;

/// Parses the header at the beginning of `bytes`, and checks it against the size of the file.
/// Requires: `bytes` is the whole file, or its first npy_header_max_bytes.
/// Throws: Error{bad_input} that begins with `file`.
NpyHeader parse_npy_header(std::span<const std::byte> bytes, std::uint64_t file_size, std::string_view file);

/// Returns a header of version 1.0. Its length is a multiple of 64 bytes and at least 128.
/// A header of shape (m, 2) always has 128 bytes, so it can be written before m is known, and overwritten later.
std::string make_npy_header(NpyType type, std::span<const std::uint64_t> shape);

}  // namespace octopair::io
