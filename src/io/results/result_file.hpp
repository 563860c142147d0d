// Reads the results that octopair writes: pairs (.npy), and pairs, events and collisions as text (.csv, .jsonl). ResultFrames: the collisions
// of a result frame by frame, from rows of single frames or from events.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <stop_token>
#include <string>
#include <vector>

#include "io/results/pair_writer.hpp"
#include "octopair/collision.hpp"
#include "octopair/objects.hpp"

namespace octopair::io {

/// Collisions of one frame, ascending by pair.
struct ResultFrame {
    std::vector<Pair> pairs;
    std::vector<Finding> findings;  ///< one per pair, or empty
};

/// A row of a result.
struct ResultRow {
    Pair pair = {};  ///< a < b
    std::uint32_t frame = 0;
    std::optional<Event> event = {};  ///< nothing: the pair collides in the frame
    Finding finding = {};
};

/// Collects rows, then returns the collisions of any frame. A row takes 20 bytes, and a finding if the class of the row is known.
class ResultFrames {
public:
    void add(ResultRow row);
    /// Sorts the rows. Returns false if some rows have events and some have none.
    bool finish();

    /// The functions below require that finish() returned true.
    /// Returns the number of frames up to the last row, at least 1.
    std::uint64_t size() const { return frames_; }
    /// Returns the collisions of any frame. They do not change after the last event.
    ResultFrame frame(std::uint64_t number) const;
    bool has_contacts() const;

private:
    static constexpr std::uint32_t no_finding = 0xFFFFFFFF, no_end = 0xFFFFFFFF;
    struct Entry {
        Pair pair;
        std::uint32_t frame;
        std::uint32_t finding;  // position in findings_
        std::optional<Event> event;
    };
    /// A pair collides in the frames from `begin` to the one before `end`.
    struct Lifetime {
        Pair pair;
        std::uint32_t begin, end;
        std::uint32_t finding;
    };

    void pair_up_events();
    void append(ResultFrame& frame, Pair pair, std::uint32_t finding) const;

    std::vector<Entry> rows_;          // sorted by frame, then by pair; empty if rows have events
    std::vector<Lifetime> lifetimes_;  // sorted by pair, then by begin
    std::vector<Finding> findings_;
    std::uint32_t frames_ = 1;
    std::size_t events_ = 0;
};

struct ResultFile {
    ResultFrames frames;
    bool moving = false;            ///< true if rows or the name of the file have a frame number
    std::uint64_t first_frame = 0;  ///< number of the first of `frames`: that in the name, as in pairs.000003.npy
    std::map<std::uint32_t, std::string> names;
    std::uint64_t objects = 0;  ///< 1 more than the largest index
};

/// Returns whether the content of a file is a result, not a scene.
bool is_result(const std::string& path);

/// Throws: Error{bad_input} that names the file and the row; Error{io_failed, cancelled}.
ResultFile read_result(const std::string& path, const std::stop_token& stop);

}  // namespace octopair::io
