// Tests the header of .npy files: accepted headers, refused headers and their messages. No damaged header is accepted.
#include "io/boxes/npy_header.hpp"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <numeric>

#include "io/boxes/npy.hpp"
#include "io/temporary.hpp"

namespace octopair::test {
namespace {

using io::NpyHeader;
using io::NpyType;

NpyHeader parsed_header(const std::string& file) {
    return io::parse_npy_header(std::as_bytes(std::span(file)), file.size(), "f.npy");
}

std::string header_refusal(const std::string& file) {
    return error_of(ErrorCode::bad_input, [&] { (void)parsed_header(file); });
}

/// Returns a file of version `major` with the dict literal `dict`, padded, and `data_bytes` of data.
std::string file_of(const std::string& dict, std::size_t data_bytes, char major = 1) {
    std::string text = dict;
    while ((text.size() + 1 + (major == 1 ? 10 : 12)) % 64 != 0) text += ' ';
    text += '\n';
    std::string file = "\x93NUMPY";
    file += major;
    file += '\0';
    file += char(text.size() & 0xff);
    file += char(text.size() >> 8);
    if (major > 1) file += std::string(2, '\0');
    return file + text + std::string(data_bytes, 'x');
}

const std::string boxes_dict = "{'descr': '<f4', 'fortran_order': False, 'shape': (3, 6), }";

TEST(NpyHeader, AcceptsWhatNumpyWrites) {
    for (const char version : {'\1', '\2', '\3'}) {
        const NpyHeader header = parsed_header(file_of(boxes_dict, 72, version));
        EXPECT_EQ(header.type, NpyType::float32);
        EXPECT_EQ(header.shape, (std::vector<std::uint64_t>{3, 6}));
        EXPECT_EQ(header.data_offset % 64, 0u);
    }
    EXPECT_EQ(parsed_header(file_of("{'descr': '<f8', 'fortran_order': False, 'shape': (3,), }", 24)).shape.size(), 1u);
    EXPECT_EQ(parsed_header(file_of("{'descr': '<u8', 'fortran_order': False, 'shape': (), }", 8)).shape.size(), 0u);
}

TEST(NpyHeader, AcceptsOtherLayoutsOfTheSameDict) {
    EXPECT_EQ(parsed_header(file_of("{\"shape\":(3,6),\"descr\":\"<f4\",\"fortran_order\":False}", 72)).shape[0], 3u);
    EXPECT_EQ(
        parsed_header(file_of("{ 'fortran_order' : False , 'descr' : '<f4' , 'shape' : ( 3 , 6 , ) , }", 72)).shape[0],
        3u);
}

TEST(NpyHeader, AcceptsOtherOrdersAndLongLengths) {
    const NpyHeader header =
        parsed_header(file_of("{'descr': '>f8', 'fortran_order': True, 'shape': (3L, 6L), }", 3 * 6 * 8));
    EXPECT_EQ(header.type, NpyType::float64);
    EXPECT_TRUE(header.big_endian);
    EXPECT_TRUE(header.fortran_order);
    EXPECT_EQ(header.shape, (std::vector<std::uint64_t>{3, 6}));
    const NpyHeader plain = parsed_header(file_of(boxes_dict, 72));
    EXPECT_FALSE(plain.big_endian);
    EXPECT_FALSE(plain.fortran_order);
    for (const std::string shape : {"(3LL, 6)", "(3l, 6)", "(L, 6)", "(3 L, 6)"}) {
        const std::string dict = "{'descr': '<f4', 'fortran_order': False, 'shape': " + shape + "}";
        EXPECT_NE(header_refusal(file_of(dict, 72)), "") << shape;
    }
}

TEST(NpyHeader, SaysWhatItFound) {
    const auto dict = [](const std::string& type, const std::string& order, const std::string& shape) {
        return "{'descr': '" + type + "', 'fortran_order': " + order + ", 'shape': " + shape + ", }";
    };
    EXPECT_EQ(header_refusal(""), "f.npy: is empty");
    EXPECT_EQ(header_refusal("PK\x03\x04 something"),
              "f.npy: not an npy file: it begins with 'PK\\x03\\x04 s'; save the array with numpy.save");
    EXPECT_EQ(header_refusal(file_of(boxes_dict, 72, 4)),
              "f.npy: npy format version 4.0; versions 1.0, 2.0 and 3.0 are supported");
    EXPECT_EQ(header_refusal(file_of(dict("<u4", "True", "(3, 6)"), 72)),
              "f.npy: its integers are in Fortran order; save numpy.ascontiguousarray(array)");
    EXPECT_EQ(header_refusal(file_of(dict(">u4", "False", "(3, 6)"), 72)),
              "f.npy: its integers are big endian; save array.astype('<u4')");
    for (const std::string type : {"<i4", "=f4", "|f4", "<f2", "f4", "", "<"}) {
        EXPECT_EQ(header_refusal(file_of(dict(type, "False", "(3, 6)"), 72)),
                  "f.npy: its array is of type '" + type + "'; '<f4' or '<f8' is needed: save array.astype('<f8')");
    }
    EXPECT_EQ(header_refusal(file_of(dict(">f4", "False", "(3, 6)"), 71)),
              "f.npy: the file is truncated: shape (3, 6) of '>f4' needs 72 bytes of data, found 71");
    EXPECT_EQ(header_refusal(file_of(dict("<f4", "False", "(3, 6)"), 71)),
              "f.npy: the file is truncated: shape (3, 6) of '<f4' needs 72 bytes of data, found 71");
    EXPECT_EQ(header_refusal(file_of(dict("<f4", "False", "(3, 6)"), 73)),
              "f.npy: the file has trailing bytes: shape (3, 6) of '<f4' needs 72 bytes of data, found 73");
    EXPECT_TRUE(
        has_text(header_refusal(file_of("{'descr': [('a', '<f4')], 'fortran_order': False, 'shape': (3,), }", 12)),
                 "structured"));
}

TEST(NpyHeader, RefusesShapesBeyond64Bits) {
    const std::string begin = "{'descr': '<f4', 'fortran_order': False, 'shape': ";
    for (const std::string shape :
         {"(4294967296, 4294967296, 6)", "(18446744073709551615, 6)", "(2305843009213693952, 8)",
          "(18446744073709551616, 6)", "(99999999999999999999999999, 6)"}) {
        for (const std::size_t data : {std::size_t(0), std::size_t(24)}) {
            EXPECT_NE(header_refusal(file_of(begin + shape + ", }", data)), "") << shape;
        }
    }
}

TEST(NpyHeader, RefusesWhatIsNotExactlyTheDict) {
    const std::vector<std::string> wrong = {
        "",
        "{}",
        "{'descr': '<f4', 'fortran_order': False}",
        "{'descr': '<f4', 'fortran_order': False, 'shape': (3, 6), 'more': 1}",
        "{'descr': '<f4', 'descr': '<f4', 'fortran_order': False, 'shape': (3, 6)}",
        "{'descr': '<f4', 'fortran_order': false, 'shape': (3, 6)}",
        "{'descr': '<f4', 'fortran_order': 0, 'shape': (3, 6)}",
        "{'descr': '<f4', 'fortran_order': False, 'shape': [3, 6]}",
        "{'descr': '<f4', 'fortran_order': False, 'shape': (03, 6)}",
        "{'descr': '<f4', 'fortran_order': False, 'shape': (+3, 6)}",
        "{'descr': '<f4', 'fortran_order': False, 'shape': (-3, 6)}",
        "{'descr': '<f4', 'fortran_order': False, 'shape': (3 6)}",
        "{'descr': '<f4', 'fortran_order': False, 'shape': (3,, 6)}",
        "{'descr': '<f4', 'fortran_order': False, 'shape': (3, 6}",
        "{'descr': '<f4', 'fortran_order': False 'shape': (3, 6)}",
        "{'descr': '<f4', 'fortran_order': False, 'shape': (3, 6)",
        "{'descr': '<f4', 'fortran_order': False, 'shape': (3, 6)} x",
        "{'descr': \"<f4', 'fortran_order': False, 'shape': (3, 6)}",
        "\t{'descr': '<f4', 'fortran_order': False, 'shape': (3, 6)}",
    };
    for (const std::string& dict : wrong) EXPECT_NE(header_refusal(file_of(dict, 72)), "") << dict;
    EXPECT_NE(header_refusal(file_of("{'descr': '<f4', 'fortran_order': False, 'shape': (18)}", 72)), "");
}

TEST(NpyHeader, RefusesMoreThan64KiB) {
    EXPECT_EQ(parsed_header(file_of(boxes_dict + std::string(65'000, ' '), 72, 2)).shape.size(), 2u);
    std::string file = file_of(boxes_dict + std::string(66'000, ' '), 72, 2);
    file[10] = '\1';  // file_of() writes the lower 16 bits of the length
    EXPECT_TRUE(has_text(header_refusal(file), "which is too long"));
}

TEST(NpyHeader, RefusesEveryPrefix) {
    for (const char version : {'\1', '\2', '\3'}) {
        const std::string whole = file_of(boxes_dict, 72, version);
        for (std::size_t size = 0; size < whole.size(); ++size)
            EXPECT_NE(header_refusal(whole.substr(0, size)), "") << size;
    }
}

TEST(NpyHeader, RefusesEveryBitFlip) {
    const TemporaryDirectory directory;
    for (const char version : {'\1', '\2', '\3'}) {
        const std::string whole = file_of(boxes_dict, 72, version);
        for (std::size_t bit = 0; bit < 8 * (whole.size() - 72); ++bit) {
            std::string flipped = whole;
            flipped[bit / 8] = char(flipped[bit / 8] ^ 1 << bit % 8);
            // Versions 2.0 and 3.0 differ in a single bit, and the file is valid in both versions.
            const bool same_file = version > 1 && bit == 6 * 8;
            const bool other_byte_order = bit == 8 * whole.find('<') + 1;  // '>'
            if (same_file || other_byte_order) continue;
            const std::string path = directory.file("flipped.npy");
            write_file(path, flipped);
            EXPECT_NE(error_of(ErrorCode::bad_input, [&] { (void)io::read_npy_scene(path); }), "") << bit;
        }
    }
}

RC_GTEST_PROP(NpyHeader, RoundTrip, ()) {
    const auto type = *rc::gen::element(NpyType::float32, NpyType::float64, NpyType::uint32, NpyType::uint64);
    const auto shape =
        *rc::gen::resize(4, rc::gen::container<std::vector<std::uint64_t>>(rc::gen::inRange<std::uint64_t>(0, 90000)));
    const std::string header = io::make_npy_header(type, shape);
    RC_ASSERT(header.size() % 64 == 0);
    const std::uint64_t elements =
        std::accumulate(shape.begin(), shape.end(), std::uint64_t(1), std::multiplies<std::uint64_t>());
    const std::uint64_t size = header.size() + elements * io::item_bytes(type);
    const NpyHeader parsed = io::parse_npy_header(std::as_bytes(std::span(header)), size, "f.npy");
    RC_ASSERT(parsed.type == type);
    RC_ASSERT(parsed.shape == shape);
    RC_ASSERT(parsed.data_offset == header.size());
}

TEST(NpyHeader, OfPairsIsAlways128BytesLong) {
    for (const std::uint64_t m : {std::uint64_t(0), std::uint64_t(1), ~std::uint64_t(0)}) {
        EXPECT_EQ(io::make_npy_header(NpyType::uint32, std::array<std::uint64_t, 2>{m, 2}).size(), 128u);
    }
}

}  // namespace
}  // namespace octopair::test
