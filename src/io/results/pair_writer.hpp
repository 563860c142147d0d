// Result files of pairs: .npy, .csv and .jsonl, written as the pairs come.
//
//   npy    uint32, shape (m, 2); of a moving scene one file a frame, NAME.000000.npy. Its header is written when m is
//   known.
//   csv    header "a,b", or "frame,a,b" of a moving scene
//   jsonl  {"a":0,"b":5}; of a moving scene with "frame" first; with "a_name" and "b_name" where an object has a name
//
// A file appears whole, with finish() (npy of a moving scene: with end_frame()), or not at all.
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

/// NAME.npy and 7 give NAME.000007.npy.
std::string frame_path(const std::string& path, std::uint64_t frame);

/// The names of what a and b of a pair count: empty, or one an object. Borrowed.
struct PairNames {
    const std::vector<std::string>* a = nullptr;
    const std::vector<std::string>* b = nullptr;
};

/// Calls come as begin_frame, write (any number), end_frame, for each frame (a scene that does not move: one), then
/// finish.
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

/// The one for the ending of `path`.
std::unique_ptr<PairWriter> make_file_writer(const std::string& path, bool moving, const PairNames& names);

}  // namespace octopair::io
