// Address, Access and gzip: what a page server reads from requests of any sender.
#include <gtest/gtest.h>

#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <random>

#include "support/page_data.hpp"
#include "viewer/scene/answer.hpp"
#include "viewer/server/access.hpp"

namespace octopair::test {

namespace {

using viewer::Access;
using viewer::AccessRequest;
using viewer::Address;

std::string path_of(std::string_view target) {
    const auto address = Address::parse(target);
    return address ? address->path() : "refused";
}

TEST(ViewAddress, HasPathAndParameters) {
    const auto address = Address::parse("/near/0.bin?min=0,-1.5,2e3&max=1,1,1&empty=&alone");
    ASSERT_TRUE(address);
    EXPECT_EQ(address->path(), "near/0.bin");
    EXPECT_EQ(address->parts(), (std::vector<std::string_view>{"near", "0.bin"}));
    EXPECT_EQ(address->parameter("min"), "0,-1.5,2e3");
    EXPECT_EQ(address->parameter("max"), "1,1,1");
    EXPECT_EQ(address->parameter("empty"), "");
    EXPECT_EQ(address->parameter("alone"), "");
    EXPECT_EQ(address->parameter("other"), "");
}

TEST(ViewAddress, DecodesPercentSigns) {
    EXPECT_EQ(path_of("/a%20b%2Fc"), "a b/c");
    EXPECT_EQ(path_of("/a+b"), "a+b");
    EXPECT_EQ(path_of("/%c3%A4"), "\xC3\xA4");
    EXPECT_EQ(Address::parse("/s?q=a+b%2B%26c")->parameter("q"), "a b+&c");
    EXPECT_EQ(Address::parse("/s?q=a=b?c")->parameter("q"), "a=b?c");
    EXPECT_EQ(Address::parse("/s?q=1&q=2")->parameter("q"), "2");
}

TEST(ViewAddress, RefusesMalformedTargets) {
    for (const std::string_view target :
         {"", "a", "*", "http://127.0.0.1/", "/%", "/%4", "/%4g", "/%g4", "/%%41", "/a?%", "/a?q=%zz", "/a?%zz=1",
          "/%00", "/a%00b", "/a?q=%00", "/a?%00=1", "/% 1", "/%-1", "/%+1"}) {
        EXPECT_EQ(path_of(target), "refused") << target;
    }
}

TEST(ViewAddress, RefusesTraversal) {
    for (const std::string_view target : {"/..", "/.", "/../etc/passwd", "/a/../b", "/a/..", "/./a", "/%2e%2e/a",
                                          "/%2E./a", "/a%2f..%2fb", "/..%2fa", "/a/.%2e?x=1"}) {
        EXPECT_EQ(path_of(target), "refused") << target;
    }
    EXPECT_EQ(path_of("/..."), "...");
    EXPECT_EQ(path_of("/a..b"), "a..b");
    EXPECT_EQ(path_of("/%252e%252e/a"), "%2e%2e/a");  // decoded once
    EXPECT_EQ(Address::parse("/a?q=..")->parameter("q"), "..");
}

TEST(ViewAddress, EdgesOfTheQuery) {
    EXPECT_EQ(path_of("/"), "");
    EXPECT_EQ(path_of("/?"), "");
    EXPECT_EQ(path_of("/??"), "");
    EXPECT_EQ(path_of("/a?&&&"), "a");
    EXPECT_EQ(path_of("//a//"), "/a//");
    EXPECT_EQ(Address::parse("/a?=v")->parameter(""), "v");
}

TEST(ViewAddress, BelowAFolder) {
    EXPECT_EQ(Address::parse("/scene/7/view.json?q=1")->below("scene").path(), "7/view.json");
    EXPECT_EQ(Address::parse("/scene/7/view.json?q=1")->below("scene").parameter("q"), "1");
    EXPECT_EQ(Address::parse("/scene")->below("scene").path(), "");
}

TEST(ViewAddress, RandomTargetsNeverHaveDotsOrZeros) {
    std::mt19937 random(7);
    constexpr std::string_view letters = "/.%?&=+20eEfF\0aZ";
    for (int i = 0; i < 50'000; ++i) {
        std::string target = "/";
        for (std::size_t k = random() % 16; k > 0; --k) target += letters[random() % letters.size()];
        const auto address = Address::parse(target);
        if (!address) continue;
        EXPECT_EQ(address->path().find('\0'), std::string::npos) << target;
        for (const std::string_view part : address->parts()) EXPECT_TRUE(part != "." && part != "..") << target;
    }
}

TEST(ViewAddress, WholeNumbers) {
    EXPECT_EQ(viewer::whole_number("0"), 0u);
    EXPECT_EQ(viewer::whole_number("18446744073709551615"), ~std::uint64_t(0));
    for (const std::string_view text : {"", "-1", "+1", " 1", "1 ", "1.0", "0x1", "18446744073709551616", "one"}) {
        EXPECT_FALSE(viewer::whole_number(text)) << text;
    }
}

AccessRequest from(std::string_view host) {
    return {.host = host, .origin = {}, .cookie = {}, .authorization = {}, .token = {}};
}
AccessRequest from(std::string_view host, std::string_view origin) {
    AccessRequest request = from(host);
    request.origin = origin;
    request.has_origin = true;
    return request;
}

TEST(ViewAccess, AcceptsItsOwnHost) {
    const Access access("127.0.0.1", 8080, "");
    for (const std::string_view host : {"127.0.0.1:8080", "localhost:8080", "LocalHost:8080"}) {
        EXPECT_TRUE(access.allows(from(host))) << host;
    }
    for (const std::string_view host : {"",
                                        "127.0.0.1",
                                        "localhost",
                                        "127.0.0.1:8081",
                                        "127.0.0.1:80800",
                                        "127.0.0.1:08080",
                                        "127.0.0.2:8080",
                                        "evil.example:8080",
                                        "127.0.0.1.evil.example:8080",
                                        "evil.example:8080:8080",
                                        "localhost.:8080",
                                        "localhost:8080 ",
                                        " localhost:8080",
                                        "user@localhost:8080",
                                        "[::1]:8080",
                                        "xlocalhost:8080",
                                        ":8080",
                                        "0.0.0.0:8080",
                                        "127.1:8080",
                                        "2130706433:8080",
                                        "localhost:8080/x",
                                        "localhost:8080,localhost:8080"}) {
        EXPECT_FALSE(access.allows(from(host))) << host;
    }
}

TEST(ViewAccess, PortEightyMayBeAbsent) {
    const Access access("127.0.0.1", 80, "");
    EXPECT_TRUE(access.allows(from("127.0.0.1")));
    EXPECT_TRUE(access.allows(from("localhost")));
    EXPECT_TRUE(access.allows(from("127.0.0.1:80")));
    EXPECT_FALSE(access.allows(from("evil.example")));
}

TEST(ViewAccess, HostOfVersion6) {
    const Access access("::1", 8080, "");
    EXPECT_TRUE(access.allows(from("[::1]:8080")));
    EXPECT_TRUE(access.allows(from("localhost:8080")));
    EXPECT_TRUE(access.allows(from("[::1]:8080", "http://[::1]:8080")));
    EXPECT_FALSE(access.allows(from("::1:8080")));
    EXPECT_FALSE(access.allows(from("[::2]:8080")));
    EXPECT_FALSE(access.allows(from("127.0.0.1:8080")));
}

TEST(ViewAccess, RefusesForeignOrigins) {
    const Access access("127.0.0.1", 8080, "");
    EXPECT_TRUE(access.allows(from("127.0.0.1:8080", "http://127.0.0.1:8080")));
    EXPECT_TRUE(access.allows(from("localhost:8080", "http://LOCALHOST:8080")));
    for (const std::string_view origin :
         {"", "null", "http://evil.example", "http://127.0.0.1", "http://127.0.0.1:8081", "https://127.0.0.1:8080",
          "http://localhost:8080", "http://127.0.0.1:8080/", "http://127.0.0.1:8080.evil.example", "file://",
          "HTTP//127.0.0.1:8080", "127.0.0.1:8080", "http://127.0.0.1:8080 http://evil.example"}) {
        EXPECT_FALSE(access.allows(from("127.0.0.1:8080", origin))) << origin;
    }
}

TEST(ViewAccess, AllAddressesAcceptNumbersOnly) {
    const Access access("0.0.0.0", 8080, "token0123456789ab");
    AccessRequest request = from("10.0.0.7:8080");
    EXPECT_FALSE(access.allows(request));
    request.token = "token0123456789ab";
    EXPECT_TRUE(access.allows(request));
    for (const std::string_view host : {"evil.example:8080", "localhost.evil:8080", "10.0.0.7", "10.0.0.7:80"}) {
        request.host = host;
        EXPECT_FALSE(access.allows(request)) << host;
    }
}

TEST(ViewAccess, NeedsTheToken) {
    const Access access("127.0.0.1", 8080, "abcdef0123456789");
    const std::string_view host = "127.0.0.1:8080";
    EXPECT_FALSE(access.allows(from(host)));
    AccessRequest by_token = from(host);
    by_token.token = "abcdef0123456789";
    EXPECT_TRUE(access.allows(by_token));
    EXPECT_TRUE(access.introduces(by_token));
    for (const std::string_view wrong : {"", "abcdef012345678", "abcdef0123456789a", "ABCDEF0123456789"}) {
        by_token.token = wrong;
        EXPECT_FALSE(access.allows(by_token)) << wrong;
        EXPECT_FALSE(access.introduces(by_token)) << wrong;
    }
    for (const std::string_view cookie : {"octopair_8080=abcdef0123456789", "a=b; octopair_8080=abcdef0123456789",
                                          "octopair_8080=abcdef0123456789; c=d", ";;octopair_8080=abcdef0123456789"}) {
        AccessRequest request = from(host);
        request.cookie = cookie;
        EXPECT_TRUE(access.allows(request)) << cookie;
        EXPECT_FALSE(access.introduces(request)) << cookie;
    }
    for (const std::string_view cookie :
         {"octopair_8080", "octopair_8080=", "octopair_8081=abcdef0123456789", "xoctopair_8080=abcdef0123456789",
          "octopair_8080=abcdef0123456789x", "octopair_80800=abcdef0123456789", "=abcdef0123456789"}) {
        AccessRequest request = from(host);
        request.cookie = cookie;
        EXPECT_FALSE(access.allows(request)) << cookie;
    }
    AccessRequest bearer = from(host);
    bearer.authorization = "Bearer abcdef0123456789";
    EXPECT_TRUE(access.allows(bearer));
    bearer.authorization = "Basic abcdef0123456789";
    EXPECT_FALSE(access.allows(bearer));
    bearer.authorization = "Bearer ";
    EXPECT_FALSE(access.allows(bearer));
    // The token does not open the server to a foreign page.
    by_token.token = "abcdef0123456789";
    by_token.origin = "http://evil.example";
    by_token.has_origin = true;
    EXPECT_FALSE(access.allows(by_token));
}

TEST(ViewAccess, WithoutTokenNoneIntroduces) {
    const Access access("127.0.0.1", 8080, "");
    EXPECT_FALSE(access.introduces(from("127.0.0.1:8080")));
}

TEST(ViewAccess, CookieIsClosedToScriptsAndOtherSites) {
    const std::string cookie = Access("127.0.0.1", 8080, "abcdef0123456789").cookie();
    EXPECT_EQ(cookie, "octopair_8080=abcdef0123456789; Path=/; HttpOnly; SameSite=Strict");
}

TEST(ViewAccess, ConnectionsOfThisUser) {
    namespace asio = boost::asio;
    using Tcp = asio::ip::tcp;
    asio::io_context io;
    for (const char* host : {"127.0.0.1", "::1"}) {
        Tcp::acceptor acceptor(io, {asio::ip::make_address(host), 0});
        Tcp::socket peer(io);
        peer.connect(acceptor.local_endpoint());
        Tcp::socket served = acceptor.accept();
        const viewer::Endpoint from{host, peer.local_endpoint().port()}, to{host, acceptor.local_endpoint().port()};
        EXPECT_TRUE(is_own_user(from, to)) << host;
        // A connection between other addresses is another one, even with equal ports.
        EXPECT_FALSE(is_own_user({"127.0.0.2", from.port}, to));
        EXPECT_FALSE(is_own_user(from, {"127.0.0.2", to.port}));
        EXPECT_FALSE(is_own_user(to, {host, 1}));
    }
}

TEST(ViewGzip, GivesTheBytesBack) {
    std::mt19937 random(3);
    for (const std::size_t size : {0u, 1u, 2u, 100u, 65'535u, 65'536u, 300'000u}) {
        std::string bytes(size, '\0');
        for (char& byte : bytes) byte = char(random() % (size % 2 == 0 ? 4 : 256));
        for (const int level : {1, 9}) {
            const std::string compressed = viewer::gzip(bytes, level);
            EXPECT_EQ(compressed.substr(0, 2), "\x1f\x8b");
            EXPECT_TRUE(unpacked(compressed) == bytes) << size;
            EXPECT_TRUE(viewer::gzip(bytes, level) == compressed) << size;
        }
    }
}

}  // namespace

}  // namespace octopair::test
