// Tests that messages of the protocol keep their fields: an older client and a newer server understand each other.
#include <google/protobuf/descriptor.h>
#include <gtest/gtest.h>

#include <fstream>
#include <set>
#include <string>

#include "service/protocol/octopair.pb.h"

namespace octopair::test {
namespace {

using Lines = std::set<std::string>;

void add_values(const google::protobuf::EnumDescriptor& type, Lines& lines) {
    for (int i = 0; i < type.value_count(); ++i) {
        const auto& value = *type.value(i);
        lines.insert(std::string(type.full_name()) + " " + std::string(value.name()) + " " +
                     std::to_string(value.number()));
    }
}

/// Adds one line per field of a message and of the messages within it: message, field, number, type.
void add_fields(const google::protobuf::Descriptor& message, Lines& lines) {
    for (int i = 0; i < message.field_count(); ++i) {
        const auto& field = *message.field(i);
        lines.insert(std::string(message.full_name()) + " " + std::string(field.name()) + " " +
                     std::to_string(field.number()) + (field.is_repeated() ? " repeated " : " ") + field.type_name());
    }
    for (int i = 0; i < message.nested_type_count(); ++i) add_fields(*message.nested_type(i), lines);
    for (int i = 0; i < message.enum_type_count(); ++i) add_values(*message.enum_type(i), lines);
}

Lines fields_of_the_protocol() {
    const google::protobuf::FileDescriptor& file = *v1::JobSpec::descriptor()->file();
    Lines lines;
    for (int i = 0; i < file.message_type_count(); ++i) add_fields(*file.message_type(i), lines);
    for (int i = 0; i < file.enum_type_count(); ++i) add_values(*file.enum_type(i), lines);
    return lines;
}

/// A released field stays as it is. A new field gets a line in the file.
TEST(ProtocolFields, KeepNumbersAndTypes) {
    std::ifstream file(OCTOPAIR_SOURCE "/tests/service/protocol_fields.txt");
    Lines pinned;
    for (std::string line; std::getline(file, line);) pinned.insert(line);
    const Lines now = fields_of_the_protocol();
    EXPECT_GT(now.size(), 100u);
    for (const std::string& line : pinned) EXPECT_TRUE(now.contains(line)) << "changed or removed: " << line;
    for (const std::string& line : now) EXPECT_TRUE(pinned.contains(line)) << "add to protocol_fields.txt: " << line;
}

}  // namespace
}  // namespace octopair::test
