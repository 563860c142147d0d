// Writes result files of collisions: .jsonl and .csv (docs/formats.md). The collisions are streamed, not collected.
// The columns of a row: collision_columns.hpp.
//
//   jsonl  {"a":0,"b":5,"a_name":"left","b_name":"right","class":"penetrating","depth":0.5,"contacts":[...]}; unknown keys
//          are left out
//   csv    header "a,b,a_name,b_name,class,distance,depth,time,contacts,points,more_contacts,depth_kind,open,thickness,thickness_kind"; two columns more
//          for each detail that an object has, for example ",a_type,b_type"; with a baseline ",change". Unknown fields are empty
//
// A file appears whole, with finish(), or not at all.
#pragma once

#include <memory>
#include <span>
#include <string>
#include <string_view>

#include "io/files/output_stream.hpp"
#include "io/results/collision_row.hpp"

namespace octopair::io {

class CollisionWriter {
public:
    virtual ~CollisionWriter() = default;
    /// Writes rows. Calls follow the order of the result.
    virtual void write(const CollisionRows& rows) = 0;
    /// Writes the rows of a baseline that are gone. `lines` are lines of its .jsonl file. Call it after all write() calls.
    virtual void write_gone(std::span<const std::string_view> lines) = 0;
    virtual void finish() = 0;
};

std::unique_ptr<CollisionWriter> make_collision_jsonl_writer(std::unique_ptr<OutputStream> out,
                                                             const CollisionForm& form);
std::unique_ptr<CollisionWriter> make_collision_csv_writer(std::unique_ptr<OutputStream> out,
                                                           const CollisionForm& form);

/// Returns the writer for the ending of `path`.
/// Throws: Error{usage} for other endings, and for .npy, which can hold pairs only; Error{io_failed}.
std::unique_ptr<CollisionWriter> make_collision_file_writer(const std::string& path, const CollisionForm& form);

}  // namespace octopair::io
