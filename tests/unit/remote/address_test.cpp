#include <doctest/doctest.h>

#include "engine/base/error.h"
#include "engine/remote/address.h"

using namespace shvr;

namespace {

std::string refusal_of(const std::string& text)
{
    try {
        static_cast<void>(parse_address(text));
    } catch (const Error& error) {
        return error.what();
    }
    return {};
}

bool contains(const std::string& text, const std::string& part)
{
    return text.find(part) != std::string::npos;
}

// Kind (Servers): addresses of three schemes, with ports, spaces, encoded bytes, and keys that hold "=", "+" and "%"
TEST_CASE("remote: addresses become URLs")
{
    CHECK(url_of(parse_address("HTTP://Example.ORG:8080/Scan.zarr/")) == "http://example.org:8080/Scan.zarr");
    CHECK(url_of(parse_address("https://h/a b/\xC3\xA9")) == "https://h/a%20b/%C3%A9");
    CHECK(url_of(parse_address("https://h/a%20b/x=1+2")) == "https://h/a%20b/x=1+2");
    CHECK(url_of(parse_address("https://[::1]:9000/x")) == "https://[::1]:9000/x");
    CHECK(url_of(parse_address("https://h")) == "https://h");
    const Address key = parse_address("s3://my-bucket/a=b+c d%20?#/x.zarr");
    CHECK(key.scheme == Scheme::s3);
    CHECK(key.host == "my-bucket");
    CHECK(key.path == "/a%3Db%2Bc%20d%2520%3F%23/x.zarr");
}

TEST_CASE("remote: what is no address that can be read is refused in words")
{
    CHECK(contains(refusal_of("ftp://h/x"), "has the scheme \"ftp\"; expected http, https or s3"));
    CHECK(contains(refusal_of("http:///x"), "has no valid host"));
    CHECK(contains(refusal_of("http://h:0/x"), "has no valid host"));
    CHECK(contains(refusal_of("http://h:99999/x"), "has no valid host"));
    CHECK(contains(refusal_of("http://h h/x"), "has no valid host"));
    CHECK(contains(refusal_of("s3:///key"), "has no valid bucket"));
    CHECK(contains(refusal_of("s3://b:1/key"), "has no valid bucket"));
    CHECK(contains(refusal_of("http://h/../x"), "has \".\" or \"..\" in its path"));
    CHECK(contains(refusal_of("s3://b/a/./x"), "has \".\" or \"..\" in its path"));
    CHECK(contains(refusal_of("http://h/x\n"), "control characters"));
    CHECK(contains(refusal_of("http://h/" + std::string(5000, 'x')), "expected at most 4096"));
    for (const char* const with_password :
         {"https://me:secret@h/x", "https://secret@h/x", "ftp://me:secret@h/x", "https://h:1@secret@h/x"}) {
        CAPTURE(with_password);
        CHECK(!refusal_of(with_password).empty());
        CHECK(!contains(refusal_of(with_password), "secret"));
    }
}

TEST_CASE("remote: queries are kept apart from addresses")
{
    CHECK(take_query("https://Bucket.example/a/x.zarr/?sig=S%3D1&t=2") == "https://Bucket.example/a/x.zarr/");
    CHECK(query_for(parse_address("https://bucket.example/a/x.zarr")) == "sig=S%3D1&t=2");
    CHECK(query_for(parse_address("https://bucket.example/a/x.zarr/0")) == "sig=S%3D1&t=2");
    CHECK(query_for(parse_address("https://bucket.example/a/x.zarr2")).empty());
    CHECK(query_for(parse_address("https://bucket.example/a")).empty());
    CHECK(query_for(parse_address("http://bucket.example/a/x.zarr")).empty());
    CHECK(query_for(parse_address("https://other.example/a/x.zarr")).empty());
    CHECK(take_query("s3://b/key?x") == "s3://b/key?x");
    CHECK(take_query("folder/file?x") == "folder/file?x");
    CHECK(!contains(refusal_of("https://h/x?sig=secret"), "secret"));
}

TEST_CASE("remote: addresses stay whole as paths")
{
    CHECK(whole_path("https://h/x.zarr") == "https://h/x.zarr");
    CHECK(whole_path("x.zarr").is_absolute());
    CHECK(std::filesystem::path("https://h/x.zarr").filename() == "x.zarr");
    CHECK(leads_to_network("s3://b/k"));
    CHECK(!leads_to_network("s3:/b/k"));
}

}  // namespace
