// Writes result files of pairs: .npy, .csv and .jsonl. The pairs are streamed, not collected.
//
//   npy    uint32, shape (m, 2). A moving scene gives one file per frame, NAME.000000.npy. The header is rewritten when m is
//          known.
//   csv    header "a,b"; for a moving scene "frame,a,b"
//   jsonl  {"a":0,"b":5}; for a moving scene "frame" comes first; "a_name" and "b_name" follow if an object has a name
//
// A file appears whole or not at all. It appears with finish(), the .npy files of a moving scene with end_frame().
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "io/files/output_stream.hpp"
#include "io/formats.hpp"
#include "octopair/objects.hpp"

namespace octopair::io {

/// Returns the path of one frame's file: NAME.npy and 7 give NAME.000007.npy.
std::string frame_path(const std::string& path, std::uint64_t frame);

/// Names of the sets that a and b of a pair are numbers in. Each is empty, or has one name per object. Borrowed.
struct PairNames {
    const std::vector<std::string>* a = nullptr;
    const std::vector<std::string>* b = nullptr;
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

/// Returns the writer for the ending of `path`. Throws: what result_format() throws; Error{io_failed}.
std::unique_ptr<PairWriter> make_file_writer(const std::string& path, bool moving, const PairNames& names);

}  // namespace octopair::io
