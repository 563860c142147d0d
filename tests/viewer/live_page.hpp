// LivePage: a page that shows live frames, written from viewer/protocol.md alone.
#pragma once

#include <cmath>
#include <cstdint>
#include <cstring>
#include <set>
#include <stdexcept>
#include <string_view>
#include <vector>

#include "octopair/objects.hpp"

namespace octopair::test {

class LivePage {
public:
    struct Row {
        float ends[6];
        bool is_absent() const { return std::isnan(ends[0]) && std::isnan(ends[5]); }
    };

    /// Applies a live frame. Throws: std::runtime_error for a frame that breaks the protocol.
    void apply(std::string_view message) {
        rest_ = message;
        const std::uint32_t magic = word();
        require(magic == 0x4F504C56, "magic");
        const std::uint32_t number = word(), base = word(), all = word(), shown = word(), moved = word(),
                            began = word(), ended = word(), low = word(), high = word(), listed = word();
        microseconds = word();
        existing = word();
        require(existing <= all, "number of existing objects");
        for (int i = 0; i < 3; ++i) require(word() == 0, "unused words");
        is_whole = base == 0xFFFFFFFF;
        if (is_whole) {
            read_whole(all, shown, listed);
            lists_all = listed == (std::uint64_t(high) << 32 | low);
        } else {
            require(std::int64_t(base) == frame, "base frame");
            require(all == objects && shown == rows.size(), "a difference with other sizes");
            read_difference(moved, began, ended);
        }
        require(rest_.empty(), "bytes after the frame");
        require(std::int64_t(number) > frame, "a frame that is not newer");
        frame = number;
        pair_count = std::uint64_t(high) << 32 | low;
        last_bytes = message.size();
        changed_rows = moved;
        changed_pairs = began + ended;
    }

    std::int64_t frame = -1;
    std::uint32_t objects = 0, existing = 0, microseconds = 0, changed_rows = 0, changed_pairs = 0;
    std::vector<std::uint32_t> shown_objects;  ///< by row; empty: all
    std::vector<Row> rows;
    std::set<Pair> pairs;
    std::uint64_t pair_count = 0;
    bool is_whole = false, lists_all = true;
    std::size_t last_bytes = 0;

private:
    static void require(bool holds, const char* what) {
        if (!holds) throw std::runtime_error(what);
    }

    template <typename T>
    T take() {
        require(rest_.size() >= sizeof(T), "a frame that is too short");
        T value;
        std::memcpy(&value, rest_.data(), sizeof(T));
        rest_.remove_prefix(sizeof(T));
        return value;
    }
    std::uint32_t word() { return take<std::uint32_t>(); }

    void read_whole(std::uint32_t all, std::uint32_t shown, std::uint32_t listed) {
        require(shown <= all, "more rows than objects");
        objects = all;
        shown_objects.clear();
        for (std::uint32_t i = 0; shown < all && i < shown; ++i) shown_objects.push_back(word());
        rows.resize(shown);
        for (Row& row : rows) row = take<Row>();
        pairs.clear();
        for (std::uint32_t i = 0; i < listed; ++i) require(pairs.insert(take<Pair>()).second, "a pair twice");
    }

    void read_difference(std::uint32_t moved, std::uint32_t began, std::uint32_t ended) {
        std::vector<std::uint32_t> places(moved);
        for (std::uint32_t& place : places) {
            place = word();
            require(place < rows.size(), "a row that does not exist");
        }
        for (const std::uint32_t place : places) rows[place] = take<Row>();
        std::vector<Pair> more(began);
        for (Pair& pair : more) pair = take<Pair>();
        std::vector<Pair> gone(ended);
        for (Pair& pair : gone) pair = take<Pair>();
        if (!lists_all) return;
        for (const Pair pair : gone) require(pairs.erase(pair) == 1, "an end of a pair that did not exist");
        for (const Pair pair : more) require(pairs.insert(pair).second, "a begin of a pair that existed");
    }

    std::string_view rest_;
};

}  // namespace octopair::test
