// XmlParser: parses the XML of a part of a 3MF file, piece by piece, with expat.
//
// - Names are resolved: an element or attribute has the URI of its namespace, whatever its prefix is.
// - A DTD is refused, so there are no entities but those of XML itself.
// - The encoding is UTF-8 or UTF-16, or another one that expat knows.
#pragma once

#include <cstddef>
#include <cstdint>
#include <exception>
#include <memory>
#include <string>
#include <string_view>

struct XML_ParserStruct;

namespace octopair::io::three_mf {

/// A name: the URI of its namespace, empty if it has none, and the name itself.
struct XmlName {
    std::string_view space, local;

    bool operator==(const XmlName&) const = default;
};

/// The begin of an element. Valid during the call that gets it.
class XmlElement {
public:
    XmlElement(const char* name, const char* const* attributes);

    const XmlName& name() const { return name_; }
    /// Returns the value of an attribute, or null if the element does not have it. The text ends with a 0.
    const char* find(const XmlName& name) const;
    /// Returns the value of an attribute without namespace, or null.
    const char* find(std::string_view local) const { return find({{}, local}); }

private:
    XmlName name_;
    const char* const* attributes_;  // name, value, ..., null
};

/// Gets what a parser finds, in the order of the text.
class XmlHandler {
public:
    virtual ~XmlHandler() = default;
    /// A prefix stands for a namespace within the element that follows. An empty prefix is that of elements without one.
    virtual void prefix([[maybe_unused]] std::string_view prefix, [[maybe_unused]] std::string_view uri) {}
    virtual void begin(const XmlElement& element) = 0;
    virtual void end() = 0;
};

class XmlParser {
public:
    /// `place`: the file and the part, for messages. Borrows the handler.
    XmlParser(std::string place, XmlHandler& handler);
    ~XmlParser();
    XmlParser(const XmlParser&) = delete;
    XmlParser& operator=(const XmlParser&) = delete;

    /// Parses the next piece of the text.
    /// Throws: Error{bad_input} "PLACE: line N: ..." if the text is not well formed, or has a DTD; what the handler throws.
    void parse(std::string_view piece);
    /// Ends the text. Throws: as parse().
    void finish();

    /// Returns the number of the current line, from 1 on.
    std::uint64_t line() const;
    const std::string& place() const { return place_; }

private:
    struct Callbacks;
    void flush(bool last);
    [[noreturn]] void refuse_text() const;

    std::string place_;
    XmlHandler& handler_;
    std::unique_ptr<XML_ParserStruct, void (*)(XML_ParserStruct*)> parser_;
    std::exception_ptr thrown_;  // by the handler
    std::string waiting_;        // text that is not parsed yet
    std::size_t batch_;          // bytes to collect before they are parsed
    std::uint64_t events_ = 0;   // calls of the handler for the last batch
};

}  // namespace octopair::io::three_mf
