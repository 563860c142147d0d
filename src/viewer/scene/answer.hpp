// Address: what a page requests. Answer: the data that the server returns. Also the messages that the server sends to pages by
// WebSocket (viewer/protocol.md).
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace octopair::viewer {

/// An address below the page: the decoded path without the leading slash, and the parameters of the query.
class Address {
public:
    /// Parses the target of a request, such as "/near/0.bin?min=0,0,0". Returns nothing for a malformed target, and for a path
    /// with "." or ".." between slashes.
    static std::optional<Address> parse(std::string_view target);

    const std::string& path() const { return path_; }
    /// Returns the parts between the slashes of the path.
    std::vector<std::string_view> parts() const;
    /// Returns a parameter of the query; empty if it is not there.
    std::string_view parameter(const std::string& name) const;
    /// Returns the address without the first part of its path.
    Address below(std::string_view first) const;

private:
    std::string path_;
    std::map<std::string, std::string> parameters_;
};

/// Returns the whole number that the text is; nothing for any other text.
std::optional<std::uint64_t> whole_number(std::string_view text);

enum class AnswerKind : std::uint8_t { json, binary };

/// The data of an address, not compressed.
struct Answer {
    AnswerKind kind = AnswerKind::binary;
    std::string body;
};

/// Appends the bytes of an array.
template <typename T>
void append_array(std::string& body, std::span<const T> values) {
    body.append(reinterpret_cast<const char*>(values.data()), values.size_bytes());
}
template <typename T>
Answer binary_answer(std::span<const T> values) {
    Answer answer;
    append_array(answer.body, values);
    return answer;
}

/// Compresses with gzip. `level`: from 1 (fast) to 9 (small). The same input gives the same bytes.
/// Throws: std::bad_alloc.
std::string gzip(std::string_view bytes, int level);

/// Returns the bytes as text in base64.
std::string base64(std::string_view bytes);

// Messages to pages over the WebSocket (viewer/protocol.md), as JSON.

/// Returns the message about the progress of the activity `what`. `done`: from 0 to 1.
std::string progress_message(std::string_view what, double done);
/// Returns the message that the source is loaded, so that the page can request data.
std::string ready_message();
/// Returns the message that loading has failed, so that the page gets no data.
std::string failed_message(std::string_view why);
/// Returns the message that the watched server does not answer, and that the program will call the server again.
std::string waiting_message(std::string_view why);
/// Returns the message that timeline.json has more frames. `done`: number of its frames.
std::string timeline_message(std::uint64_t done);
/// Returns the message that the watched scene has ended.
std::string closed_message();

}  // namespace octopair::viewer
