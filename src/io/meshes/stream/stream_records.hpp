// Records of a model stream (docs/formats.md#model-streams): each is a kind, a length, and as many bytes.
//
// A stream may come from a program that somebody else wrote, or end at any byte. So a reader never allocates what a length says before the
// bytes have arrived, and never reads beyond the record.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "io/meshes/read_budget.hpp"
#include "io/meshes/stream/byte_source.hpp"

namespace octopair::io {

enum class StreamRecord : std::uint32_t {
    model = 1,     ///< what holds for all objects
    shape = 2,     ///< a mesh
    instance = 3,  ///< an object: a shape in a place
    element = 4,   ///< the element that the reader works on, for messages
    warning = 5,   ///< a text for the user
    failure = 6,   ///< why the file cannot be read
    end = 7        ///< counts; the last record
};

class StreamRecords {
public:
    /// Reads the beginning of the stream. The source and the budget are borrowed.
    /// Throws: Error{bad_input} if the stream has another beginning or version; what the source throws.
    StreamRecords(const ByteSource& source, ReadBudget& budget);

    /// Goes on to the next record, whose kind may be unknown. Skips what is left of the record before.
    /// Throws: Error{bad_input} if the stream has ended; Error{cancelled}; what the source throws.
    StreamRecord next();

    // Values of the record. Throw: Error{bad_input} if the record is too short; what the source throws.
    std::uint8_t byte();
    std::uint32_t number32();
    std::uint64_t number64();
    double real();
    /// Reads an array of `count` values. Throws: Error{resource_limit}, too.
    template <typename T>
    std::vector<T> array(std::uint64_t count);
    std::string text();
    /// Throws: Error{bad_input} if something is left of the record.
    void finish();

    /// Throws: Error{bad_input} if bytes follow.
    void check_at_end();
    [[noreturn]] void refuse(std::string_view what) const;

private:
    template <typename T>
    T value();
    void take(std::span<std::byte> bytes);
    void fill(std::span<std::byte> bytes);

    const ByteSource& source_;
    ReadBudget& budget_;
    std::vector<std::byte> buffer_;
    std::span<const std::byte> arrived_;  // bytes of buffer_ that are not consumed yet
    std::uint64_t left_ = 0;              // bytes of the record that are not consumed yet
};

}  // namespace octopair::io
