#include "viewer/pages.hpp"

#include <fcntl.h>
#include <signal.h>
#include <spawn.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/beast/core.hpp>
#include <boost/beast/websocket.hpp>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <mutex>
#include <stdexcept>
#include <thread>
#include <vector>

extern char** environ;

namespace octopair::bench {

namespace {

namespace asio = boost::asio;
namespace beast = boost::beast;
using tcp = asio::ip::tcp;

struct Received {
    std::mutex mutex;
    std::uint64_t frames = 0;
    std::vector<double> differences;
    double whole = 0;

    void add(std::size_t bytes, bool is_whole) {
        const std::lock_guard lock(mutex);
        ++frames;
        if (is_whole) {
            whole = double(bytes);
        } else {
            differences.push_back(double(bytes));
        }
    }
};

class Page {
public:
    explicit Page(const std::string& endpoint) : socket_(context_) {
        const std::size_t colon = endpoint.rfind(':');
        socket_.next_layer().connect(
            {asio::ip::make_address(endpoint.substr(0, colon)), std::uint16_t(std::stoul(endpoint.substr(colon + 1)))});
        socket_.read_message_max(std::size_t(1) << 30);
        socket_.handshake(endpoint, "/socket");
    }

    /// Reads frames until the server ends.
    void run(Reading reading, Received& received) {
        beast::error_code error;
        std::int64_t last = -1;
        for (;;) {
            want(last, error);
            if (error || !read_frame(last, received)) return;
            if (reading == Reading::all) continue;
            want(-1, error);
            for (;;) ::pause();
        }
    }

private:
    void want(std::int64_t frame, beast::error_code& error) {
        socket_.write(asio::buffer("{\"want\": " + std::to_string(frame) + "}"), error);
    }

    bool read_frame(std::int64_t& last, Received& received) {
        for (;;) {
            beast::flat_buffer buffer;
            beast::error_code error;
            socket_.read(buffer, error);
            if (error) return false;
            if (socket_.got_text()) continue;
            std::array<std::uint32_t, 3> head;
            std::memcpy(head.data(), buffer.data().data(), sizeof head);
            last = head[1];
            received.add(buffer.size(), head[2] == 0xFFFFFFFF);
            return true;
        }
    }

    asio::io_context context_;
    beast::websocket::stream<tcp::socket> socket_;
};

}  // namespace

int run_pages(const std::string& address, unsigned pages, Reading reading) {
    ::setpriority(PRIO_PROCESS, 0, 19);
    const std::size_t begin = address.find("//") + 2;
    const std::string endpoint = address.substr(begin, address.find('/', begin) - begin);
    Received received;
    std::vector<std::thread> threads;
    for (unsigned i = 0; i < pages; ++i) {
        threads.emplace_back([&] {
            try {
                Page(endpoint).run(reading, received);
            } catch (const std::exception& error) {
                std::fprintf(stderr, "page: %s\n", error.what());
            }
        });
    }
    for (std::thread& thread : threads) thread.join();
    auto& differences = received.differences;
    std::sort(differences.begin(), differences.end());
    std::printf("%llu %g %g %g\n", static_cast<unsigned long long>(received.frames),
                differences.empty() ? 0 : differences[differences.size() / 2],
                differences.empty() ? 0 : differences.back(), received.whole);
    return 0;
}

PageProcess::PageProcess(const std::string& address, unsigned pages, Reading reading) {
    std::array<int, 2> ends;
    if (::pipe2(ends.data(), O_CLOEXEC) != 0) throw std::runtime_error("no pipe");
    posix_spawn_file_actions_t files;
    posix_spawn_file_actions_init(&files);
    posix_spawn_file_actions_adddup2(&files, ends[1], 1);
    std::string program = "/proc/self/exe", word = "--pages", count = std::to_string(pages), where = address,
                how = reading == Reading::all ? "all" : "first";
    char* const arguments[] = {program.data(), word.data(), where.data(), count.data(), how.data(), nullptr};
    const int error = ::posix_spawn(&child_, "/proc/self/exe", &files, nullptr, arguments, environ);
    posix_spawn_file_actions_destroy(&files);
    ::close(ends[1]);
    output_ = ends[0];
    if (error != 0) throw std::runtime_error("cannot start the process of the pages");
}

void PageProcess::kill() {
    if (child_ < 0) return;
    ::kill(child_, SIGKILL);
    ::waitpid(child_, nullptr, 0);
    ::close(output_);
    child_ = -1;
}

PageBytes PageProcess::wait() {
    PageBytes bytes;
    if (child_ < 0) return bytes;
    std::string text;
    std::array<char, 256> part;
    for (ssize_t count; (count = ::read(output_, part.data(), part.size())) > 0;)
        text.append(part.data(), std::size_t(count));
    unsigned long long frames = 0;
    std::sscanf(text.c_str(), "%llu %lf %lf %lf", &frames, &bytes.median_difference, &bytes.largest_difference,
                &bytes.whole);
    bytes.frames = frames;
    kill();
    return bytes;
}

}  // namespace octopair::bench
