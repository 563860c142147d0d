// Writes result files of events: the pairs that begin and end from frame to frame. The formats are .csv and .jsonl.
//
//   csv    header "frame,event,a,b"; the event is "begin" or "end"
//   jsonl  {"frame":0,"event":"begin","a":0,"b":5}; "a_name" and "b_name" follow if an object has a name
//
// A file appears whole, with finish(), or not at all.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>

#include "io/results/pair_rows.hpp"

namespace octopair::io {

enum class Event : std::uint8_t { begin, end };

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
