#include "io/files/line_splitter.hpp"

#include <algorithm>

namespace octopair::io {

LineSplitter::LineSplitter(std::string_view text) : text_(text) {
    constexpr std::string_view byte_order_mark = "\xef\xbb\xbf";
    if (text.starts_with(byte_order_mark)) next_ = byte_order_mark.size();
    line_feed_ = std::min(text.find('\n', next_), text.size());
}

bool LineSplitter::find_carriage_return() {
    // Searching far beyond the line once costs less than a separate search in each of the next lines.
    constexpr std::size_t beyond = 1 << 14;
    const std::size_t begin = std::max(carriage_return_, next_);
    const std::string_view searched = text_.substr(begin, line_feed_ - begin + beyond);
    carriage_return_ = begin + std::min(searched.find('\r'), searched.size());
    return carriage_return_ < line_feed_;
}

void LineSplitter::end_line(std::size_t carriage_return) {
    line_ = text_.substr(next_, carriage_return - next_);
    next_ = carriage_return + 1;
    const bool alone = next_ == text_.size() || text_[next_] != '\n';
    if (number_ == 1) cr_alone_ = alone;
    if (!alone && !cr_alone_) ++next_;
}

std::uint64_t most_lines(std::string_view text) {
    auto count = std::uint64_t(std::count(text.begin(), text.end(), '\n')) + 1;
    for (std::size_t at = text.find('\r'); at != std::string_view::npos; at = text.find('\r', at + 1))
        count += at + 1 == text.size() || text[at + 1] != '\n';
    return count;
}

}  // namespace octopair::io
