// Writes result files of collisions: .jsonl and .csv (docs/formats.md). The collisions are streamed, not collected.
// Start here to add a new column of results.
//
//   jsonl  {"a":0,"b":5,"a_name":"left","b_name":"right","class":"penetrating","depth":0.5,"contacts":[...]}; unknown keys
//          are left out
//   csv    header "a,b,a_name,b_name,class,distance,depth,time,contacts,points,more_contacts,depth_kind,open"; two columns more
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

/// Selects the fields that the collisions of a result have.
struct CollisionForm {
    CollisionNames names = {};
    bool features = false;  ///< depth and contacts are known
    bool times = false;     ///< the time of first contact is known
    bool changes = false;   ///< the result is compared with a baseline
};

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

/// Returns `text` as a field of a .csv file, quoted if needed (RFC 4180). Invalid UTF-8 becomes U+FFFD.
std::string csv_field(std::string_view text);

}  // namespace octopair::io
