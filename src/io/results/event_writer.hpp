// Result files of events, the pairs that begin and end from frame to frame: .csv and .jsonl, written as they come.
//
//   csv    header "frame,event,a,b"; the event is "begin" or "end"
//   jsonl  {"frame":0,"event":"begin","a":0,"b":5}, with "a_name" and "b_name" where an object has a name
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

/// By the ending of the path: csv or jsonl. Throws Error{usage} for another ending.
ResultFormat event_format(const std::string& path);

class EventWriter {
public:
    /// Throws Error{usage} for npy.
    EventWriter(ResultFormat format, std::unique_ptr<OutputStream> out, const PairNames& names);

    /// Any number of calls for a frame and an event.
    void write(std::uint64_t frame, Event event, std::span<const Pair> pairs);
    void finish() { out_->commit(); }

private:
    ResultFormat format_;
    std::unique_ptr<OutputStream> out_;
    JsonlRows jsonl_;
};

}  // namespace octopair::io
