// Reads the metrics page of a server on this machine. The server's log contains the address of the page.
#pragma once

#include <netinet/in.h>
#include <spdlog/sinks/ostream_sink.h>
#include <sys/socket.h>

#include <array>
#include <sstream>
#include <thread>

#include "base/descriptor.hpp"
#include "service/guarded.hpp"

namespace octopair::test {

inline std::shared_ptr<spdlog::logger> log_to(std::ostringstream& log) {
    return service::make_log(service::LogForm::text, std::make_shared<spdlog::sinks::ostream_sink_mt>(log));
}

/// Connects to the metrics of the server with this log. The descriptor is not open if that fails.
inline Descriptor connect_to_metrics(const std::string& log) {
    const std::string before = "metrics at http://localhost:";
    const std::size_t found = log.find(before);
    if (found == std::string::npos) return {};
    Descriptor connection(::socket(AF_INET, SOCK_STREAM, 0));
    sockaddr_in there{};
    there.sin_family = AF_INET;
    there.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    there.sin_port = htons(std::uint16_t(std::stoi(log.substr(found + before.size()))));
    if (::connect(connection.number(), reinterpret_cast<const sockaddr*>(&there), sizeof(there)) != 0) return {};
    return connection;
}

/// Returns the metrics page of the server with this log, or an empty text if the page cannot be read.
inline std::string metrics_page(const std::string& log) {
    const Descriptor connection = connect_to_metrics(log);
    if (!connection.open()) return {};
    const std::string request = "GET /metrics HTTP/1.0\r\n\r\n";
    if (::send(connection.number(), request.data(), request.size(), 0) < 0) return {};
    std::string answer;
    std::array<char, 4096> piece{};
    for (ssize_t got = 0; (got = ::recv(connection.number(), piece.data(), piece.size(), 0)) > 0;) {
        answer.append(piece.data(), std::size_t(got));
    }
    return answer;
}

/// Waits for a minute at most until the page contains `line`.
inline ::testing::AssertionResult page_has(const std::ostringstream& log, const std::string& line) {
    const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(60);
    while (std::chrono::steady_clock::now() < end) {
        if (metrics_page(log.str()).find("\n" + line + "\n") != std::string::npos) return ::testing::AssertionSuccess();
        std::this_thread::sleep_for(std::chrono::milliseconds(20));
    }
    return ::testing::AssertionFailure() << "no line '" << line << "' in\n" << metrics_page(log.str());
}

}  // namespace octopair::test
