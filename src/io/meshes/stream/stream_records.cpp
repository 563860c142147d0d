#include "io/meshes/stream/stream_records.hpp"

#include <algorithm>
#include <cstring>
#include <limits>

#include <fmt/format.h>

#include "io/files/failure.hpp"
#include "octopair/pose.hpp"

namespace octopair::io {

namespace {

constexpr std::array<char, 8> mark = {'O', 'P', 'M', 'O', 'D', 'E', 'L', '\n'};
constexpr std::uint32_t version = 1;
constexpr std::size_t buffer_bytes = std::size_t(1) << 16;
constexpr std::uint32_t max_text_bytes = std::uint32_t(1) << 20;

static_assert(std::endian::native == std::endian::little);

}  // namespace

StreamRecords::StreamRecords(const ByteSource& source, ReadBudget& budget)
    : source_(source), budget_(budget), buffer_(buffer_bytes) {
    left_ = mark.size() + sizeof version;
    std::array<char, mark.size()> beginning{};
    take(std::as_writable_bytes(std::span(beginning)));
    if (beginning != mark) refuse("is no model stream: it does not begin with OPMODEL");
    const std::uint32_t found = number32();
    if (found != version)
        refuse(fmt::format("is a model stream of version {}; octopair reads version {}", found, version));
}

StreamRecord StreamRecords::next() {
    budget_.checkpoint();
    std::array<std::byte, 4096> skipped;
    while (left_ > 0) take(std::span(skipped).first(std::size_t(std::min<std::uint64_t>(left_, skipped.size()))));
    left_ = sizeof(std::uint32_t) + sizeof(std::uint64_t);
    const std::uint32_t kind = number32();
    left_ = number64();
    return StreamRecord(kind);
}

template <typename T>
T StreamRecords::value() {
    T value;
    take(std::as_writable_bytes(std::span(&value, 1)));
    return value;
}

std::uint8_t StreamRecords::byte() { return value<std::uint8_t>(); }
std::uint32_t StreamRecords::number32() { return value<std::uint32_t>(); }
std::uint64_t StreamRecords::number64() { return value<std::uint64_t>(); }
double StreamRecords::real() { return value<double>(); }

template <typename T>
std::vector<T> StreamRecords::array(std::uint64_t count) {
    if (count > left_ / sizeof(T)) refuse("has a record that is shorter than its numbers say");
    budget_.charge(count, sizeof(T));
    // The memory grows with the bytes that arrive.
    constexpr std::uint64_t piece = (std::uint64_t(1) << 20) / sizeof(T);
    std::vector<T> values;
    while (values.size() < count) {
        const std::size_t before = values.size();
        values.resize(std::size_t(std::min(count, before + std::max<std::uint64_t>(piece, before))));
        take(std::as_writable_bytes(std::span(values).subspan(before)));
    }
    return values;
}

template std::vector<Point3d> StreamRecords::array(std::uint64_t);
template std::vector<std::array<std::uint32_t, 3>> StreamRecords::array(std::uint64_t);

std::string StreamRecords::text() {
    const std::uint32_t bytes = number32();
    if (bytes > max_text_bytes)
        refuse(fmt::format("has a text of {} bytes; the longest has {}", bytes, max_text_bytes));
    budget_.charge(bytes, 1);
    std::string text(std::min<std::uint64_t>(bytes, left_), '\0');
    if (text.size() < bytes) refuse("has a record that is shorter than its numbers say");
    take(std::as_writable_bytes(std::span(text)));
    return text;
}

void StreamRecords::finish() {
    if (left_ > 0) refuse(fmt::format("has a record with {} bytes too many", left_));
}

void StreamRecords::check_at_end() {
    std::byte more;
    if (!arrived_.empty() || source_({&more, 1}) > 0) refuse("goes on after its last record");
}

void StreamRecords::refuse(std::string_view what) const { io::refuse(budget_.path(), what); }

void StreamRecords::take(std::span<std::byte> bytes) {
    if (bytes.size() > left_) refuse("has a record that is shorter than its numbers say");
    left_ -= bytes.size();
    fill(bytes);
}

void StreamRecords::fill(std::span<std::byte> bytes) {
    while (!bytes.empty()) {
        if (arrived_.empty()) {
            const std::size_t got = source_(buffer_);
            if (got == 0) refuse("ends early: the record with the counts is missing");
            arrived_ = std::span(buffer_).first(got);
        }
        const std::size_t size = std::min(bytes.size(), arrived_.size());
        std::copy_n(arrived_.begin(), size, bytes.begin());
        arrived_ = arrived_.subspan(size);
        bytes = bytes.subspan(size);
    }
}

}  // namespace octopair::io
