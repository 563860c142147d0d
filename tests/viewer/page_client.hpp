// PageClient: reads a page server by HTTP and WebSocket, as a page does. All calls wait; they throw if the server ends the connection.
#pragma once

#include <boost/asio/connect.hpp>
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/beast/core.hpp>
#include <boost/beast/http.hpp>
#include <boost/beast/websocket.hpp>
#include <optional>
#include <string>

namespace octopair::test {

/// Host and port of an address such as "http://127.0.0.1:1234/".
inline std::string endpoint_of(const std::string& address) {
    const std::size_t begin = address.find("//") + 2;
    return address.substr(begin, address.find('/', begin) - begin);
}

inline boost::asio::ip::tcp::socket connected_socket(boost::asio::io_context& context, const std::string& endpoint) {
    boost::asio::ip::tcp::socket socket(context);
    const std::size_t colon = endpoint.rfind(':');
    socket.connect({boost::asio::ip::make_address(endpoint.substr(0, colon)),
                    std::uint16_t(std::stoul(endpoint.substr(colon + 1)))});
    return socket;
}

struct PageResponse {
    unsigned status = 0;
    std::string body;
};

/// Sends one request.
inline PageResponse get_page(const std::string& address, const std::string& target) {
    namespace http = boost::beast::http;
    boost::asio::io_context context;
    auto socket = connected_socket(context, endpoint_of(address));
    http::request<http::empty_body> request(http::verb::get, target, 11);
    request.set(http::field::host, endpoint_of(address));
    http::write(socket, request);
    boost::beast::flat_buffer buffer;
    http::response_parser<http::string_body> parser;
    parser.body_limit(1 << 30);
    http::read(socket, buffer, parser);
    return {unsigned(parser.get().result_int()), parser.get().body()};
}

class PageClient {
public:
    explicit PageClient(const std::string& address) : socket_(connected_socket(context_, endpoint_of(address))) {
        socket_.read_message_max(1 << 30);
        socket_.handshake(endpoint_of(address), "/socket");
    }

    void want(std::int64_t frame) { send("{\"want\": " + std::to_string(frame) + "}"); }
    void send(const std::string& text) {
        socket_.text(true);
        socket_.write(boost::asio::buffer(text));
    }

    struct Message {
        bool text = false;
        std::string body;
    };
    /// Waits for a message. Returns nothing if the connection ends first.
    std::optional<Message> read() {
        boost::beast::flat_buffer buffer;
        boost::beast::error_code error;
        socket_.read(buffer, error);
        if (error) return std::nullopt;
        return Message{socket_.got_text(), boost::beast::buffers_to_string(buffer.data())};
    }

private:
    boost::asio::io_context context_;
    boost::beast::websocket::stream<boost::asio::ip::tcp::socket> socket_;
};

}  // namespace octopair::test
