// Tests the reader of PLY with random files, in all encodings and spellings of the format, whose content is known.
#include <gtest/gtest.h>

#include <bit>
#include <string>
#include <vector>

#include "io/spelling.hpp"

namespace octopair::test {
namespace {

/// A type of numbers. `integer`: the largest number is `most`.
struct PlyType {
    const char *name, *other_name;
    unsigned bytes;
    bool integer;
    std::uint64_t most;
};
constexpr PlyType ply_types[] = {{"char", "int8", 1, true, 127},     {"uchar", "uint8", 1, true, 255},
                                 {"short", "int16", 2, true, 1000},  {"ushort", "uint16", 2, true, 1000},
                                 {"int", "int32", 4, true, 1000000}, {"uint", "uint32", 4, true, 1000000},
                                 {"float", "float32", 4, false, 0},  {"double", "float64", 8, false, 0}};
constexpr std::uint64_t integer_types = 6;

struct PlyProperty {
    std::string name;
    PlyType type;
    const PlyType* count = nullptr;  ///< of a list
};

struct PlyElement {
    std::string name;
    std::uint64_t count;
    std::vector<PlyProperty> properties;
};

/// A random PLY file: its bytes, and what it says.
class PlyFile {
public:
    explicit PlyFile(std::uint64_t seed)
        : spelling_(seed), encoding_(spelling_.below(3)), is_stream_(is_text() && spelling_.one_in(2)) {
        const std::uint64_t vertices = 1 + spelling_.below(6);
        mesh_.vertices.resize(vertices);
        std::vector<PlyElement> elements = {{"vertex", vertices, some_properties({"x", "y", "z"})},
                                            {"face", spelling_.below(6), some_properties({"vertex_indices"})}};
        for (std::uint64_t others = spelling_.below(3); others > 0; --others)
            elements.push_back({"edge", spelling_.below(4), some_properties({})});
        spelling_.shuffle(elements);
        write_header(elements);
        for (const PlyElement& element : elements) {
            for (std::uint64_t i = 0; i < element.count; ++i) write_element(element, i);
        }
        if (!is_stream_ && spelling_.one_in(8)) write_rest();
    }

    const std::string& bytes() const { return bytes_; }
    const io::PlainMesh& mesh() const { return mesh_; }
    Spelling& spelling() { return spelling_; }
    std::uint64_t warnings() const { return warnings_; }

private:
    bool is_text() const { return encoding_ == 0; }

    /// Returns the named properties among others, in any order.
    std::vector<PlyProperty> some_properties(const std::vector<std::string>& names) {
        std::vector<PlyProperty> properties;
        for (const std::string& name : names) {
            if (name == "vertex_indices") {
                const PlyType& type = ply_types[spelling_.below(8)];
                properties.push_back({spelling_.pick({"vertex_indices", "vertex_index"}), type, any_integer()});
            } else {
                properties.push_back({name, ply_types[spelling_.below(8)]});
                const PlyType& type = properties.back().type;
                mesh_.rounded |= !is_text() && !type.integer && type.bytes == 4;
            }
        }
        for (std::uint64_t others = spelling_.below(3); others > 0; --others) {
            const PlyType& type = ply_types[spelling_.below(8)];
            properties.push_back(
                {spelling_.pick({"red", "nx", "quality"}), type, spelling_.one_in(3) ? any_integer() : nullptr});
        }
        spelling_.shuffle(properties);
        return properties;
    }
    const PlyType* any_integer() { return &ply_types[spelling_.below(integer_types)]; }

    void write_header(const std::vector<PlyElement>& elements) {
        bytes_ = (is_text() ? spelling_.byte_order_mark() : "") + "ply";
        end_line();
        bytes_ += std::string("format ") +
                  (is_text()        ? "ascii"
                   : encoding_ == 1 ? "binary_little_endian"
                                    : "binary_big_endian") +
                  " 1.0";
        end_line();
        for (const PlyElement& element : elements) {
            while (spelling_.one_in(3)) {
                bytes_ += spelling_.pick({"comment end_header", "obj_info a b", "comment", "comment element face 7"});
                end_line();
            }
            bytes_ += "element" + spelling_.blank() + element.name + spelling_.blank() + std::to_string(element.count);
            end_line();
            for (const PlyProperty& property : element.properties) {
                bytes_ += "property ";
                if (property.count != nullptr)
                    bytes_ += "list" + spelling_.blank() + name_of(*property.count) + spelling_.blank();
                bytes_ += name_of(property.type) + spelling_.blank() + property.name;
                end_line();
            }
        }
        bytes_ += "end_header";
        end_line();
    }
    std::string name_of(const PlyType& type) { return spelling_.pick({type.name, type.other_name}); }
    void end_line() { bytes_ += (spelling_.one_in(4) && is_text() ? spelling_.blank() : "") + spelling_.line_end(); }

    void write_element(const PlyElement& element, std::uint64_t number) {
        for (const PlyProperty& property : element.properties) {
            if (property.name.starts_with("vertex_ind")) {
                write_corners(property);
            } else if (property.name.size() == 1) {
                mesh_.vertices[number][std::size_t(property.name[0] - 'x')] = write_number(property.type);
            } else {
                const std::uint64_t values = property.count != nullptr ? spelling_.below(4) : 1;
                if (property.count != nullptr) write_integer(*property.count, values);
                for (std::uint64_t i = 0; i < values; ++i) write_skipped(property.type);
            }
        }
        if (!is_text() || is_stream_) return;
        end_line();
        if (spelling_.one_in(8)) end_line();
    }
    /// Writes what separates values of a text.
    void separate() {
        if (is_stream_ && spelling_.one_in(3)) {
            end_line();
        } else {
            bytes_ += spelling_.blank();
        }
    }

    void write_corners(const PlyProperty& property) {
        const std::uint64_t corners = spelling_.below(6);
        write_integer(*property.count, corners);
        for (std::uint64_t i = 0; i < corners; ++i) {
            const std::uint64_t corner = spelling_.below(mesh_.vertices.size());
            write_integer(property.type, corner);
            mesh_.corners.push_back(std::uint32_t(corner));
        }
        mesh_.end_face();
    }

    void write_skipped(const PlyType& type) {
        if (is_text() && spelling_.one_in(6)) {
            bytes_ += "-nan";
            separate();
        } else {
            (void)write_number(type);
        }
    }

    /// Writes a random number of a type, and returns it.
    double write_number(const PlyType& type) {
        if (type.integer) {
            const std::uint64_t number = spelling_.below(type.most + 1);
            write_integer(type, number);
            return double(number);
        }
        if (is_text()) {
            const SpelledNumber number = spelling_.spelled();
            bytes_ += number.text;
            separate();
            return number.value;
        }
        const double any = spelling_.number();
        if (type.bytes == 8) {
            append(std::bit_cast<std::uint64_t>(any), 8);
            return any;
        }
        const float number = std::fabs(any) < 1e38 ? float(any) : -0.0F;
        append(std::bit_cast<std::uint32_t>(number), 4);
        return double(number);
    }

    /// Writes a whole number as a number of any type.
    void write_integer(const PlyType& type, std::uint64_t number) {
        if (is_text()) {
            bytes_ += std::to_string(number);
            separate();
        } else if (type.integer) {
            append(number, type.bytes);
        } else if (type.bytes == 4) {
            append(std::bit_cast<std::uint32_t>(float(number)), 4);
        } else {
            append(std::bit_cast<std::uint64_t>(double(number)), 8);
        }
    }

    void append(std::uint64_t bits, unsigned bytes) {
        for (unsigned i = 0; i < bytes; ++i) bytes_ += char(bits >> (8 * (encoding_ == 2 ? bytes - 1 - i : i)) & 0xFF);
    }

    /// Writes more than the header says.
    void write_rest() {
        bytes_ += "3 0 1 2";
        warnings_ = 1;
    }

    Spelling spelling_;
    std::uint64_t encoding_;  // 0: text; 1: little endian; 2: big endian
    bool is_stream_;          // true if lines end anywhere
    std::string bytes_;
    io::PlainMesh mesh_;
    std::uint64_t warnings_ = 0;
};

TEST(GeneratedFiles, OfPlyAreReadAsTheyAreWritten) {
    const std::stop_token without_stop;
    for (std::uint64_t i = 0; i < generated_files(); ++i) {
        const std::uint64_t seed = case_seed("ply", i);
        PlyFile file(seed);
        std::vector<std::string> warnings;
        const auto mesh = read_of_valid(seed, file.bytes(), [&] {
            return io::parse_ply({file.bytes(), "m.ply", without_stop, {}, &warnings});
        });
        ASSERT_EQ(difference(mesh, file.mesh()), "") << repetition(seed, file.bytes());
        ASSERT_EQ(mesh.rounded, file.mesh().rounded) << repetition(seed, file.bytes());
        ASSERT_EQ(warnings.size(), file.warnings()) << repetition(seed, file.bytes());

        const std::string mutated = file.spelling().mutated(file.bytes());
        const std::string fault = fault_of_reading("m.ply: ", [&] {
            return fault_of_mesh(io::parse_ply({mutated, "m.ply", without_stop}));
        });
        ASSERT_EQ(fault, "") << repetition(seed, mutated);
    }
}

}  // namespace
}  // namespace octopair::test
