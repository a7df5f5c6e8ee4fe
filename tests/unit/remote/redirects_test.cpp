#include <doctest/doctest.h>

#include "engine/base/error.h"
#include "engine/remote/local_host.h"
#include "engine/remote/redirects.h"

using namespace shvr;

namespace {

std::string refusal_of(const std::string& from, const std::string& location, bool is_from_local = false)
{
    try {
        static_cast<void>(redirect_of("it", from, location, is_from_local));
    } catch (const Error& error) {
        return error.what();
    }
    return {};
}

TEST_CASE("remote: redirects that are followed")
{
    CHECK(redirect_of("it", "https://a/x/y?q=1", "/z", false).url == "https://a/z");
    CHECK(redirect_of("it", "https://a/x/y?q=1", "z?w", false).url == "https://a/x/z?w");
    CHECK(redirect_of("it", "http://a/x", "https://b/x", false).url == "https://b/x");
    CHECK(redirect_of("it", "http://a/x", "//b/x", false).url == "http://b/x");
    CHECK(redirect_of("it", "http://a/x", "https://b/x", false).refuses_local);
    CHECK(!redirect_of("it", "http://127.0.0.1/x", "http://127.0.0.1:9/x", true).refuses_local);
}

// Kind (Servers): redirects to other schemes, from https to http, to this machine, and with credentials
TEST_CASE("remote: redirects that are refused, without their query in the message")
{
    for (const auto& [from, location] : {std::pair{"http://a/x", "file:///etc/passwd?secret"},
                                         {"http://a/x", "ftp://b/x?secret"},
                                         {"http://a/x", "s3://b/x?secret"},
                                         {"https://a/x", "http://a/x?secret"},
                                         {"https://a/x", "https://me:secret@b/x"},
                                         {"https://a/x", "https://localhost/x?secret"},
                                         {"https://a/x", "https://x.localhost./x?secret"},
                                         {"https://a/x", "https://127.1/x?secret"},
                                         {"https://a/x", "https://2130706433/x?secret"},
                                         {"https://a/x", "https://0x7f000001/x?secret"},
                                         {"https://a/x", "https://169.254.169.254/x?secret"},
                                         {"https://a/x", "https://[::1]/x?secret"},
                                         {"https://a/x", "https://[::ffff:127.0.0.1]/x?secret"},
                                         {"https://a/x", "https://[fe80::1]/x?secret"},
                                         {"https://a/x", "https://0.0.0.0/x?secret"},
                                         {"https://a/x", ""},
                                         {"https://a/x", "https://b/\x01secret"}}) {
        CAPTURE(from);
        CAPTURE(location);
        const std::string refusal = refusal_of(from, location);
        CHECK(!refusal.empty());
        CHECK(refusal.find("secret") == std::string::npos);
    }
    CHECK(refusal_of("http://127.0.0.1/x", "http://[::1]/x", true).empty());
}

TEST_CASE("remote: addresses of this machine and its link")
{
    for (const char* const local : {"127.0.0.1", "127.255.0.1:80", "localhost", "LOCALHOST:1", "0.0.0.0", "169.254.1.1",
                                    "::1", "[::1]:80", "fe80::1", "[fe80::1%25eth0]", "::ffff:127.0.0.1", "::"})
        CHECK_MESSAGE(is_local_host(local), local);
    for (const char* const other : {"example.org", "10.0.0.1", "192.168.1.1", "8.8.8.8:80", "[2001:db8::1]:443",
                                    "::ffff:8.8.8.8", "localhost.example.org", "128.0.0.1"})
        CHECK_MESSAGE(!is_local_host(other), other);
}

}  // namespace
