// Writes result files of pairs (.npy, .csv and .jsonl), and of events: the pairs that begin and end from frame to frame (.csv and .jsonl).
// The pairs are streamed, not collected.
//
// Pairs:
//
//   npy    uint32, shape (m, 2). A moving scene gives one file per frame, NAME.000000.npy. The header is rewritten when m is
//          known.
//   csv    header "a,b"; for a moving scene "frame,a,b"
//   jsonl  {"a":0,"b":5}; for a moving scene "frame" comes first; "a_name" and "b_name" follow if an object has a name
//
// Events:
//
//   csv    header "frame,event,a,b"; the event is "begin" or "end"
//   jsonl  {"frame":0,"event":"begin","a":0,"b":5}; names follow as above
//
// A file appears whole or not at all. It appears with finish(), the .npy files of a moving scene with end_frame().
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "io/files/output_stream.hpp"
#include "io/formats/format_choice.hpp"
#include "octopair/objects.hpp"

namespace octopair::io {

/// Returns the path of one frame's file: NAME.npy and 7 give NAME.000007.npy.
std::string frame_path(const std::string& path, std::uint64_t frame);

/// Names of the objects of the set of `a` and the set of `b`. Each array is empty, or has one name per object. Borrowed.
struct PairNames {
    const std::vector<std::string>* a = nullptr;
    const std::vector<std::string>* b = nullptr;
};

// All rows of one call begin with the same text, for example a frame and an event.

/// Writes rows `BEGINa,b`. `begin` includes its commas. Requires: `begin` has at most 64 characters.
void write_csv_rows(OutputStream& out, std::string_view begin, std::span<const Pair> pairs);

/// Writes rows `{BEGIN"a":0,"b":5}`, with the names of objects that have one. `begin` includes its commas.
class JsonlRows {
public:
    explicit JsonlRows(const PairNames& names) : names_(names) {}

    void write(OutputStream& out, std::string_view begin, std::span<const Pair> pairs);

private:
    void append_number(std::string_view before, std::uint32_t number);
    void append_name(std::string_view key, const std::vector<std::string>* names, std::uint32_t object);

    PairNames names_;
    std::string line_;
};

/// Writes pairs. Requires: for each frame begin_frame(), any number of write(), end_frame(); after all frames finish().
/// A scene that does not move has one frame.
class PairWriter {
public:
    virtual ~PairWriter() = default;
    virtual void begin_frame(std::uint64_t frame) = 0;
    virtual void write(std::span<const Pair> pairs) = 0;
    virtual void end_frame() = 0;
    virtual void finish() = 0;
};

std::unique_ptr<PairWriter> make_npy_writer(const std::string& path, bool moving);
std::unique_ptr<PairWriter> make_csv_writer(std::unique_ptr<OutputStream> out, bool moving);
std::unique_ptr<PairWriter> make_jsonl_writer(std::unique_ptr<OutputStream> out, bool moving, const PairNames& names);

/// Returns the writer for the ending of `path`. Throws: what pairs_format() throws; Error{io_failed}.
std::unique_ptr<PairWriter> make_file_writer(const std::string& path, bool moving, const PairNames& names);

/// Change of a pair in a frame. In one frame, ends come before begins.
enum class Event : std::uint8_t { end, begin };

/// Returns the format by the ending of the path: csv or jsonl. Throws: Error{usage} for another ending.
ResultFormat event_format(const std::string& path);

class EventWriter {
public:
    /// Throws: Error{usage} for npy.
    EventWriter(ResultFormat format, std::unique_ptr<OutputStream> out, const PairNames& names);

    /// Writes rows. It may be called several times for one frame and event.
    void write(std::uint64_t frame, Event event, std::span<const Pair> pairs);
    void finish() { out_->commit(); }

private:
    ResultFormat format_;
    std::unique_ptr<OutputStream> out_;
    JsonlRows jsonl_;
};

}  // namespace octopair::io
