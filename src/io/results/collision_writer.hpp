// Result files of collisions: .jsonl and .csv, written as they come (docs/formats.md).
//
//   jsonl  {"a":0,"b":5,"a_name":"left","b_name":"right","class":"penetrating","depth":0.5,"contacts":[...]}; what is not
//          known is left out
//   csv    header "a,b,a_name,b_name,class,distance,depth,time,contacts,points,more_contacts", and ",change" where there is a
//          baseline; a field that is not known is empty
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

/// What is known of the collisions of a result.
struct CollisionForm {
    CollisionNames names = {};
    bool features = false;  ///< depth and contacts
    bool times = false;     ///< when two first meet
    bool changes = false;   ///< there is a baseline
};

class CollisionWriter {
public:
    virtual ~CollisionWriter() = default;
    /// In the order of the result.
    virtual void write(const CollisionRows& rows) = 0;
    /// Old rows that are no more, after all others: lines of an older .jsonl file.
    virtual void write_gone(std::span<const std::string_view> lines) = 0;
    virtual void finish() = 0;
};

std::unique_ptr<CollisionWriter> make_collision_jsonl_writer(std::unique_ptr<OutputStream> out,
                                                             const CollisionForm& form);
std::unique_ptr<CollisionWriter> make_collision_csv_writer(std::unique_ptr<OutputStream> out,
                                                           const CollisionForm& form);

/// The one for the ending of `path`. Throws Error{usage} for .npy, which holds pairs alone, and other endings.
std::unique_ptr<CollisionWriter> make_collision_file_writer(const std::string& path, const CollisionForm& form);

/// As a field of a .csv file: in quotes where it needs them (RFC 4180); what is not UTF-8 becomes U+FFFD.
std::string csv_field(std::string_view text);

}  // namespace octopair::io
