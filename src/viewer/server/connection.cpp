#include "viewer/server/connection.hpp"

#include <boost/asio/post.hpp>
#include <boost/beast/core.hpp>
#include <boost/beast/http.hpp>
#include <boost/beast/websocket.hpp>
#include <deque>
#include <memory>
#include <nlohmann/json.hpp>

#include "octopair/error.hpp"
#include "viewer/scene/page.hpp"

namespace octopair::viewer {

namespace {

namespace asio = boost::asio;
namespace beast = boost::beast;
namespace http = beast::http;
namespace websocket = beast::websocket;
using Tcp = asio::ip::tcp;
using BeastError = beast::error_code;
using Request = http::request<http::empty_body>;
using Response = http::response<http::string_body>;
using namespace std::chrono_literals;

std::string_view view_of(beast::string_view text) { return {text.data(), text.size()}; }

std::string_view header_of(const Request& request, http::field field) { return view_of(request[field]); }

AccessRequest access_request(const Request& request, const std::optional<Address>& address) {
    return {.host = header_of(request, http::field::host),
            .origin = header_of(request, http::field::origin),
            .cookie = header_of(request, http::field::cookie),
            .authorization = header_of(request, http::field::authorization),
            .token = address ? address->parameter("token") : std::string_view(),
            .has_origin = request.find(http::field::origin) != request.end()};
}

std::string trimmed(std::string_view text) {
    const std::size_t begin = std::min(text.find_first_not_of(" \t"), text.size());
    return std::string(text.substr(begin, text.find_last_not_of(" \t") + 1 - begin));
}

/// Returns whether a weight of Accept-Encoding is above 0 (RFC 9110, 12.4.2).
bool is_accepted(const http::param_list& parameters) {
    for (const auto& [name, value] : parameters) {
        if (beast::iequals(name, "q")) return value.find_first_not_of("0.") != beast::string_view::npos;
    }
    return true;
}

bool accepts_gzip(const Request& request) {
    std::optional<bool> gzip, any;
    const auto [begin, end] = request.equal_range(http::field::accept_encoding);
    for (auto field = begin; field != end; ++field) {
        // Beast's ext_list gives a coding without parameters those of the coding before it.
        for (beast::string_view rest = field->value(); !rest.empty();) {
            const beast::string_view one = rest.substr(0, rest.find(','));
            rest.remove_prefix(std::min(rest.size(), one.size() + 1));
            const beast::string_view words = one.substr(0, one.find(';'));
            const std::string coding = trimmed(view_of(words));
            const http::param_list parameters(one.substr(words.size()));
            if (beast::iequals(coding, "gzip") || beast::iequals(coding, "x-gzip")) gzip = is_accepted(parameters);
            if (coding == "*") any = is_accepted(parameters);
        }
    }
    return gzip ? *gzip : any.value_or(false);
}

Response respond(const Request& request, http::status status) {
    Response response(status, request.version());
    response.set(http::field::cache_control, "no-store");
    response.set("X-Content-Type-Options", "nosniff");
    response.set("X-Frame-Options", "DENY");
    response.set("Referrer-Policy", "no-referrer");
    response.set("Cross-Origin-Resource-Policy", "same-origin");
    response.set("Cross-Origin-Opener-Policy", "same-origin");
    response.keep_alive(request.keep_alive());
    return response;
}

Response respond_text(const Request& request, http::status status, std::string text) {
    Response response = respond(request, status);
    response.set(http::field::content_type, "text/plain; charset=utf-8");
    response.body() = std::move(text) + '\n';
    return response;
}

Response respond_page(const Request& request) {
    Response response = respond(request, http::status::ok);
    response.set(http::field::content_type, "text/html; charset=utf-8");
    if (accepts_gzip(request)) {
        response.set(http::field::content_encoding, "gzip");
        static const std::string compressed = gzip(page, 9);
        response.body() = compressed;
    } else {
        response.body() = std::string(page);
    }
    return response;
}

/// Compresses an answer of at least this size: smaller ones fit into one packet.
constexpr std::size_t min_compressed = 1400;

Response respond_answer(const Request& request, Answer answer) {
    Response response = respond(request, http::status::ok);
    const bool json = answer.kind == AnswerKind::json;
    response.set(http::field::content_type, json ? "application/json" : "application/octet-stream");
    if (answer.body.size() >= min_compressed && accepts_gzip(request)) {
        response.set(http::field::content_encoding, "gzip");
        response.body() = gzip(answer.body, 1);
    } else {
        response.body() = std::move(answer.body);
    }
    return response;
}

http::status status_of(ErrorCode code) {
    switch (code) {
        case ErrorCode::bad_input:
        case ErrorCode::usage:
            return http::status::bad_request;
        case ErrorCode::resource_limit:
            return http::status::insufficient_storage;
        default:
            return http::status::internal_server_error;
    }
}

/// Computes the response to a request for data.
Response respond_data(const Request& request, const Address& address, Source& source) {
    try {
        if (source.loading()) return respond_text(request, http::status::service_unavailable, "still loading");
        std::optional<Answer> answer = source.get(address);
        if (!answer) return respond_text(request, http::status::not_found, "no such address");
        return respond_answer(request, std::move(*answer));
    } catch (const Error& error) {
        return respond_text(request, status_of(error.code()), error.what());
    } catch (const std::bad_alloc&) {
        return respond_text(request, http::status::insufficient_storage, "out of memory");
    } catch (const std::exception& error) {
        return respond_text(request, http::status::internal_server_error, error.what());
    }
}

/// Counts a connection as long as it lives.
class Counted {
public:
    explicit Counted(ConnectionHost& host) : host_(host) { host_.opened(); }
    Counted(const Counted&) = delete;
    Counted& operator=(const Counted&) = delete;
    ~Counted() { host_.closed(); }

private:
    ConnectionHost& host_;
};

class PageSocket final : public WebSocket, public std::enable_shared_from_this<PageSocket> {
public:
    PageSocket(beast::tcp_stream&& stream, ConnectionHost& host, std::string path)
        : counted_(host), host_(host), path_(std::move(path)), socket_(std::move(stream)) {}
    ~PageSocket() override {
        if (joined_) host_.left(*this);
    }

    void start(const Request& request) {
        socket_.set_option(websocket::stream_base::timeout::suggested(beast::role_type::server));
        socket_.read_message_max(max_message);
        socket_.auto_fragment(false);  // a frame goes out in one piece
        socket_.async_accept(request, [self = shared_from_this()](BeastError error) {
            if (error) return;
            self->joined_ = true;
            self->host_.joined(*self);
            for (std::string& message : self->host_.source().greeting(self->path_)) self->send(std::move(message));
            self->read();
        });
    }

    const std::string& path() const override { return path_; }
    bool is_sending() const override { return sending_; }
    std::uint64_t last_turn() const override { return turn_; }

    void send(std::string message) override {
        if (waiting_.size() < max_waiting) waiting_.push_back(std::move(message));
        write();
    }

    void offer_frame() override {
        if (!last_ || sending_ || !host_.may_send_frame()) return;
        frame_ = host_.source().live_frame(path_, *last_);
        if (frame_ == nullptr) return;
        last_.reset();
        turn_ = host_.take_turn(frame_->size());
        write();
    }

private:
    static constexpr std::size_t max_message = 1024, max_waiting = 16;
    static constexpr std::uint64_t max_frame = 0xFFFFFFFF;

    void read() {
        socket_.async_read(received_, [self = shared_from_this()](BeastError error, std::size_t) {
            if (error) return;
            if (!self->take_request()) {
                self->socket_.async_close(websocket::close_code::policy_error, [self](BeastError) {});
                return;
            }
            self->offer_frame();
            self->read();
        });
    }

    /// Takes the message {"want": N}. Returns false for any other message.
    bool take_request() {
        const std::string text = beast::buffers_to_string(received_.data());
        received_.consume(received_.size());
        const auto message = nlohmann::json::parse(text, nullptr, false);
        if (!socket_.got_text() || !message.is_object() || !message.contains("want")) return false;
        const auto& want = message["want"];
        if (!want.is_number_integer() || (want.is_number_unsigned() && want.get<std::uint64_t>() > max_frame))
            return false;
        last_ = want.get<std::int64_t>();
        return true;
    }

    void write() {
        if (sending_ || !joined_ || (waiting_.empty() && frame_ == nullptr)) return;
        sending_ = true;
        const bool text = !waiting_.empty();
        if (text) {
            outgoing_ = std::make_shared<const std::string>(std::move(waiting_.front()));
            waiting_.pop_front();
        } else {
            outgoing_ = std::exchange(frame_, nullptr);
        }
        socket_.text(text);
        socket_.async_write(asio::buffer(*outgoing_), [self = shared_from_this()](BeastError error, std::size_t) {
            self->sending_ = false;
            self->outgoing_.reset();
            if (error) return;
            self->write();
            self->offer_frame();
        });
    }

    Counted counted_;
    ConnectionHost& host_;
    std::string path_;
    websocket::stream<beast::tcp_stream> socket_;
    beast::flat_buffer received_;
    std::deque<std::string> waiting_;   // messages that are not yet sent
    Message frame_;                     // live frame that is not yet sent
    Message outgoing_;                  // being sent
    std::optional<std::int64_t> last_;  // set while the page waits for a frame: the last frame that it has
    std::uint64_t turn_ = 0;            // number of the last sent frame (ConnectionHost::take_turn)
    bool sending_ = false, joined_ = false;
};

class HttpConnection final : public Stranger, public std::enable_shared_from_this<HttpConnection> {
public:
    HttpConnection(Tcp::socket socket, ConnectionHost& host)
        : counted_(std::in_place, host), host_(host), stream_(std::move(socket)) {
        BeastError ignored;
        address_ = stream_.socket().remote_endpoint(ignored).address().to_string();
        host_.came(*this);
    }
    HttpConnection(const HttpConnection&) = delete;
    HttpConnection& operator=(const HttpConnection&) = delete;
    ~HttpConnection() override {
        if (stranger_) host_.went(*this);
    }

    const std::string& address() const override { return address_; }
    void cut() override {
        counted_.reset();  // this object lives until its pending operation has ended
        stream_.close();
    }

    void read() {
        parser_.emplace();
        parser_->header_limit(max_header);
        parser_->body_limit(0);
        // A connection that has sent no request occupies a slot, so it gets only 5 s.
        stream_.expires_after(std::exchange(first_, false) ? 5s : 30s);
        http::async_read(stream_, buffer_, *parser_, [self = shared_from_this()](BeastError error, std::size_t) {
            if (error == http::error::header_limit) return self->refuse(http::status::request_header_fields_too_large);
            if (error == http::error::body_limit) return self->refuse(http::status::payload_too_large);
            if (error) return self->close();
            self->request_ = self->parser_->release();
            self->handle();
        });
    }

private:
    static constexpr std::uint32_t max_header = 16 << 10;

    void refuse(http::status status) {
        request_ = {};
        request_.keep_alive(false);
        write(respond_text(request_, status, "the request is too large"));
    }

    void handle() {
        const std::optional<Address> address = Address::parse(view_of(request_.target()));
        const AccessRequest access = access_request(request_, address);
        if (!host_.access().allows(access)) {
            request_.keep_alive(false);  // close the connection, so that strangers do not occupy slots
            return write(respond_text(
                request_, http::status::forbidden,
                "Only pages of this viewer, with its token, get an answer. Use the address that octopair printed."));
        }
        if (std::exchange(stranger_, false)) host_.went(*this);
        if (!address) return write(respond_text(request_, http::status::bad_request, "invalid address"));
        if (websocket::is_upgrade(request_)) return upgrade(*address);
        if (request_.method() != http::verb::get && request_.method() != http::verb::head) {
            Response response = respond_text(request_, http::status::method_not_allowed, "only GET and HEAD");
            response.set(http::field::allow, "GET, HEAD");
            return write(std::move(response));
        }
        if (host_.access().introduces(access)) return redirect(*address);
        const std::vector<std::string_view> parts = address->parts();
        const bool of_scene = parts.size() == 3 && parts[0] == "scene" && parts[2].empty();
        if (address->path().empty() || of_scene) return write(respond_page(request_));
        answer(*address);
    }

    /// Answers with the cookie and a redirect to the same address without the token.
    void redirect(const Address& address) {
        Response response = respond(request_, http::status::see_other);
        response.set(http::field::set_cookie, host_.access().cookie());
        const bool plain =
            address.path().find_first_not_of("abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789-_./") ==
            std::string::npos;
        response.set(http::field::location, plain && !address.path().starts_with('/') ? '/' + address.path() : "/");
        write(std::move(response));
    }

    void upgrade(const Address& address) {
        constexpr std::string_view name = "socket";
        const std::string& path = address.path();
        if (path != name && !path.ends_with("/" + std::string(name))) {
            return write(respond_text(request_, http::status::not_found, "no such address"));
        }
        const std::size_t before = path.size() == name.size() ? 0 : path.size() - name.size() - 1;
        stream_.expires_never();
        std::make_shared<PageSocket>(std::move(stream_), host_, path.substr(0, before))->start(request_);
    }

    void answer(const Address& address) {
        stream_.expires_never();  // a long computation must not close the connection
        host_.compute([self = shared_from_this(), address] {
            auto response = std::make_shared<Response>(respond_data(self->request_, address, self->host_.source()));
            asio::post(self->stream_.get_executor(), [self, response] { self->write(std::move(*response)); });
        });
    }

    void write(Response response) {
        response.content_length(response.body().size());
        if (request_.method() == http::verb::head) response.body().clear();
        response_ = std::move(response);
        stream_.expires_after(120s);
        http::async_write(stream_, response_, [self = shared_from_this()](BeastError error, std::size_t) {
            if (error || !self->response_.keep_alive()) return self->close();
            self->response_ = {};
            self->read();
        });
    }

    void close() {
        BeastError ignored;
        stream_.socket().shutdown(Tcp::socket::shutdown_send, ignored);
    }

    std::optional<Counted> counted_;
    ConnectionHost& host_;
    std::string address_;
    bool stranger_ = true;  // until a request is answered; until then only the host's thread may destroy this object
    beast::tcp_stream stream_;
    beast::flat_buffer buffer_{max_header + 4096};
    std::optional<http::request_parser<http::empty_body>> parser_;
    bool first_ = true;  // true until the first request is read
    Request request_;
    Response response_;
};

}  // namespace

void serve_connection(Tcp::socket socket, ConnectionHost& host) {
    std::make_shared<HttpConnection>(std::move(socket), host)->read();
}

}  // namespace octopair::viewer
