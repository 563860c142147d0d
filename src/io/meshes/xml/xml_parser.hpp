// XmlParser: parses XML with expat, whole or piece by piece. All readers of XML use it, in one of two modes:
//
//                 lenient: files of many programs        strict: 3MF
//   names         as the text has them                   the URI of the namespace, whatever the prefix is, and the name
//   DTD           allowed                                refused, so there are no entities but those of XML itself
//   characters    reported                               left out
//   memory        not limited                            at most 1 GiB for expat
//   encoding      unknown ones are read as Latin-1       those of expat, such as UTF-8 and UTF-16
//
// - If the handler throws, the parser stops, and the call that parses throws the same exception.
// - The limit of memory is needed because an archive of a few megabytes can unpack to names or levels that fill the memory.
#pragma once

#include <cstddef>
#include <cstdint>
#include <exception>
#include <memory>
#include <string>
#include <string_view>

struct XML_ParserStruct;

namespace octopair::io {

/// A name: the URI of its namespace, empty if it has none, and the name itself.
struct XmlName {
    std::string_view space, local;

    bool operator==(const XmlName&) const = default;
};

/// The begin of an element. Valid during the call that gets it.
class XmlTag {
public:
    XmlTag(const char* name, const char* const* attributes);

    const XmlName& name() const { return name_; }
    /// Returns the value of an attribute, or null if the element does not have it. The text ends with a 0.
    const char* find(const XmlName& name) const;
    /// Returns the value of an attribute without namespace, or null.
    const char* find(std::string_view local) const { return find({{}, local}); }
    /// Returns the attributes: name, value, ..., null.
    const char* const* attributes() const { return attributes_; }

private:
    XmlName name_;
    const char* const* attributes_;
};

/// Receives the parts of a text that a parser finds, in the order of the text.
class XmlHandler {
public:
    virtual ~XmlHandler() = default;
    /// In the element that follows, `prefix` stands for the namespace `uri`. An empty prefix applies to elements without a prefix.
    virtual void prefix([[maybe_unused]] std::string_view prefix, [[maybe_unused]] std::string_view uri) {}
    virtual void begin(const XmlTag& tag) = 0;
    /// Receives a part of the characters between two tags.
    virtual void text([[maybe_unused]] std::string_view characters) {}
    virtual void end() = 0;
};

class XmlParser {
public:
    enum class Mode : std::uint8_t { lenient, strict };

    /// `place`: the file, or the file and the part, for messages. `encoding`: name of an encoding to use in place of the declared one, or
    /// null. Borrows the handler. Requires: the thread that makes a strict parser also uses and destroys it.
    XmlParser(std::string place, XmlHandler& handler, Mode mode, const char* encoding = nullptr);
    ~XmlParser();
    XmlParser(const XmlParser&) = delete;
    XmlParser& operator=(const XmlParser&) = delete;

    /// Parses the next piece of the text.
    /// Throws: Error{bad_input} "PLACE: line N: ..." if the text is not well-formed, or has a DTD that is refused; Error{resource_limit}; what
    /// the handler throws.
    void parse(std::string_view piece);
    /// Ends the text. Throws: as parse().
    void finish();
    /// Parses a whole text, without a copy. Throws: as parse().
    void parse_whole(std::string_view text);

    /// Returns the number of the current line, from 1 on.
    std::uint64_t line() const;
    const std::string& place() const { return place_; }

private:
    struct Callbacks;
    void flush(bool last);
    void run(std::string_view piece, bool last);
    [[noreturn]] void refuse_text() const;

    std::string place_;
    XmlHandler& handler_;
    Mode mode_;
    std::unique_ptr<XML_ParserStruct, void (*)(XML_ParserStruct*)> parser_;
    std::exception_ptr thrown_;  // exception of the handler
    std::string waiting_;        // text that is not parsed yet
    std::size_t batch_;          // bytes to collect before they are parsed
    std::uint64_t events_ = 0;   // number of calls of the handler for the last batch
};

}  // namespace octopair::io
