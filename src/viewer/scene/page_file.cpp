#include "viewer/scene/page_file.hpp"

#include <algorithm>
#include <array>

#include "octopair/error.hpp"
#include "viewer/scene/page.hpp"

namespace octopair::viewer {

namespace {

/// Returns the element with the data of an address; an empty text for an address without data.
std::string element(FrameSource& source, const std::string& address) {
    const auto parsed = Address::parse('/' + address);
    const auto answer = parsed ? source.get(*parsed) : std::nullopt;
    if (!answer) return {};
    return "<script type=\"application/octet-stream\" data-address=\"" + address + "\">" +
           base64(gzip(answer->body, 6)) + "</script>\n";
}

/// Returns the part of `text` between two marks. Requires: the text has both.
std::string_view between(std::string_view text, std::string_view begin, std::string_view end) {
    const std::size_t from = text.find(begin) + begin.size();
    return text.substr(from, text.find(end, from) - from);
}

/// The page around the data. Its script is compressed, and a short one, the loader, starts it (viewer/build.mjs).
struct PageFrame {
    std::string before, after;

    std::uint64_t size() const { return before.size() + after.size(); }
};
PageFrame page_frame() {
    constexpr std::string_view loader_begin = "<!-- loader ", loader_end = " -->",
                               script_begin = "<!-- script --><script>", script_end = "</script>";
    const std::string_view script = between(page, script_begin, script_end);
    const std::string_view loader = between(page, loader_begin, loader_end);
    const std::string_view rest =
        page.substr(page.find(script_begin) + script_begin.size() + script.size() + script_end.size());
    std::string after =
        "<script type=\"application/octet-stream\" id=\"packed\">" + base64(gzip(script, 9)) + "</script>\n<script>";
    after.append(loader).append(script_end).append(rest);
    return {std::string(page.substr(0, page.find(loader_begin))), std::move(after)};
}

/// Encodes the data of addresses. Reports the progress for an expected number of addresses.
class Encoder {
public:
    Encoder(FrameSource& source, std::uint64_t expected, const ProgressSink& progress)
        : source_(source), expected_(expected), progress_(progress) {}

    std::string elements(const std::vector<std::string>& addresses) {
        std::string all;
        for (const std::string& address : addresses) {
            all += element(source_, address);
            if (progress_) progress_(std::min(1.0, double(++encoded_) / double(expected_)));
        }
        return all;
    }

private:
    FrameSource& source_;
    std::uint64_t expected_, encoded_ = 0;
    const ProgressSink& progress_;
};

}  // namespace

std::uint64_t write_page(FrameSource& source, const std::function<void(std::string_view)>& write,
                         const PageOptions& options, const ProgressSink& progress) {
    const std::uint64_t most = options.max_bytes;
    const PageFrame around = page_frame();
    const std::uint64_t frames = source.frames();
    source.prepare_export({frames, {}, options.octants});
    const std::vector<std::string> of_scene = source.addresses(), of_first = source.addresses_of(0);
    Encoder encoder(source, 2 * of_scene.size() + frames * of_first.size(), progress);
    // The data of source.addresses() hold the number of exported frames, which is known only after the frames are added. So encode the
    // frames first.
    std::string data = encoder.elements(of_first);
    std::uint64_t written = 1;
    const std::uint64_t fixed = around.size() + encoder.elements(of_scene).size();
    const auto refuse_large = [&] {
        throw Error(ErrorCode::resource_limit, "the page would exceed " + std::to_string(most >> 20) +
                                                   " MiB; export fewer objects, or look at the scene without --export");
    };
    if (fixed + data.size() > most) refuse_large();
    for (; written < frames; ++written) {
        const std::string next = encoder.elements(source.addresses_of(written));
        if (fixed + data.size() + next.size() > most) break;
        data += next;
    }
    FrameSource::Export how{written, {}, options.octants};
    if (written < frames) {
        how.notices.push_back("Only the first " + grouped_number(written) + " of " + grouped_number(frames) +
                              " frames are in this file.");
    }
    source.prepare_export(std::move(how));
    write(around.before);
    write(encoder.elements(of_scene));
    write(data);
    write(around.after);
    return written;
}

}  // namespace octopair::viewer
