// XmlWriter: appends elements to an XML text.
#pragma once

#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace octopair::io {

class XmlWriter {
public:
    void open(std::string_view name);
    /// Requires: the element has neither text nor child so far.
    void attribute(std::string_view name, std::string_view value);
    void text(std::string_view characters);
    void close();

    std::size_t size() const { return text_.size(); }
    std::string take() { return std::move(text_); }

private:
    void end_tag();
    void escape(std::string_view characters);

    std::string text_;
    std::vector<std::string> open_;
    bool in_tag_ = false;  // the tag of the last open element has no end yet
};

}  // namespace octopair::io
