#include <doctest/doctest.h>

#include <unistd.h>

#include <atomic>
#include <filesystem>

#include "engine/base/progress.h"
#include "engine/base/waits/waits.h"
#include "engine/remote/address.h"
#include "engine/remote/deadlines.h"
#include "engine/remote/remote_folder.h"
#include "tests/support/remote/canned_transport.h"

using namespace shvr;

namespace {

using State = RemoteObject::State;
constexpr RetryPace AT_ONCE{.first_s = 0.0, .most_s = 0.0};

/// Asks for one object of https://host/x.zarr, which `answer` provides.
struct Asked {
    explicit Asked(CannedTransport::Answer answer, RemoteWant want = {.key = "k", .max_bytes = 100},
                   const std::string& address = "https://host/x.zarr")
        : transport(std::make_shared<CannedTransport>(std::move(answer)))
    {
        const RemoteFolder folder(address, transport, AT_ONCE);
        object = std::move(folder.get(std::span(&want, 1))[0]);
    }
    std::shared_ptr<CannedTransport> transport;
    RemoteObject object;
};

bool contains(const std::string& text, const std::string& part)
{
    return text.find(part) != std::string::npos;
}

TEST_CASE("remote: objects, parts of them, and missing ones")
{
    const auto answer = [](const RemoteRequest& request) { return found(request, "0123456789"); };
    const Asked whole(answer);
    CHECK(whole.object.state == State::found);
    CHECK(whole.object.bytes == bytes_of_text("0123456789"));
    CHECK(whole.object.etag == "\"1\"");
    CHECK(whole.transport->urls == std::vector<std::string>{"https://host/x.zarr/k"});
    const Asked part(answer, {.key = "a b=+", .part = ByteRange{2, 3}});
    CHECK(part.object.bytes == bytes_of_text("234"));
    CHECK(part.object.object_bytes == 10);
    CHECK(part.transport->urls[0] == "https://host/x.zarr/a%20b%3D%2B");
    CHECK(Asked(answer, {.key = "k", .part = ByteRange{-4, 4}}).object.bytes == bytes_of_text("6789"));
    CHECK(Asked([](const RemoteRequest&) { return RemoteResponse{.status = 404}; }).object.state == State::missing);
    const Asked forbidden([](const RemoteRequest&) { return RemoteResponse{.status = 403}; });
    CHECK(forbidden.object.state == State::forbidden);
    CHECK(contains(forbidden.object.failure, "https://host/x.zarr/k: access is refused (status 403)"));
}

TEST_CASE("remote: failures that may pass are tried again")
{
    for (const int status : {408, 429, 500, 502, 503, 504, 0}) {
        CAPTURE(status);
        int count = 0;
        const Asked asked([&](const RemoteRequest& request) {
            if (++count < 3) return RemoteResponse{.status = status, .failure = "reset", .may_pass = true};
            return found(request, "x");
        });
        CHECK(asked.object.state == State::found);
        CHECK(count == 3);
    }
    for (const int status : {400, 405, 501, 505}) {
        const Asked asked([&](const RemoteRequest&) { return RemoteResponse{.status = status}; });
        CHECK(asked.object.state == State::failed);
        CHECK(asked.transport->rounds == 1);
        CHECK(contains(asked.object.failure, sentence("status ", status)));
    }
    const Asked ever([](const RemoteRequest&) { return RemoteResponse{.status = 503}; });
    CHECK(ever.transport->rounds == deadlines().tries);
    CHECK(contains(ever.object.failure, sentence("status 503, after ", deadlines().tries, " tries")));
    const Asked once([](const RemoteRequest&) { return RemoteResponse{.failure = "TLS fault"}; });
    CHECK(once.transport->rounds == 1);
    CHECK(contains(once.object.failure, "cannot be read: TLS fault"));
}

TEST_CASE("remote: only what failed is asked for again, in one round")
{
    std::atomic<int> failures = 2;
    const auto transport = std::make_shared<CannedTransport>([&](const RemoteRequest& request) {
        if (request.url.ends_with("bad") && failures-- > 0) return RemoteResponse{.status = 503};
        return found(request, request.url);
    });
    const RemoteFolder folder("https://host/x.zarr", transport, AT_ONCE);
    const std::vector<RemoteWant> wants{
        {.key = "a", .max_bytes = 100}, {.key = "bad", .max_bytes = 100}, {.key = "c", .max_bytes = 100}};
    const std::vector<RemoteObject> objects = folder.get(wants);
    CHECK(transport->rounds == 3);
    CHECK(transport->urls.size() == 5);
    for (size_t i = 0; i < wants.size(); ++i) CHECK(objects[i].bytes == bytes_of_text(folder.name_of(wants[i].key)));
}

// Kind (Servers): servers that ignore ranges, send other bytes than asked for, or contradict themselves
TEST_CASE("remote: answers that contradict the question are refused")
{
    const RemoteWant part{.key = "k", .part = ByteRange{2, 3}};
    const auto refused = [](const Asked& asked, const char* says) {
        CHECK(asked.object.state == State::failed);
        CHECK_MESSAGE(contains(asked.object.failure, says), asked.object.failure);
    };
    refused(
        Asked([](const RemoteRequest&) { return RemoteResponse{.status = 200, .body = bytes_of_text("012")}; }, part),
        "whole object instead of a part");
    refused(Asked([](const RemoteRequest&) { return RemoteResponse{.status = 206, .body = bytes_of_text("01")}; }),
            "only a part of it is sent");
    const auto with = [](const char* body, std::optional<int64_t> first, std::optional<int64_t> bytes) {
        return [=](const RemoteRequest&) {
            return RemoteResponse{
                .status = 206, .body = bytes_of_text(body), .range_first = first, .object_bytes = bytes};
        };
    };
    refused(Asked(with("234", 3, 10), part), "from byte 3 on; expected 3 from byte 2");
    refused(Asked(with("23", 2, 10), part), "sends 2 bytes");
    refused(Asked(with("234", {}, {}), part), "from byte -1 on");
    refused(Asked(with("234", 2, 1), part), "holds 1 bytes; expected at least 3");
    refused(Asked(with("234", 7, {}), {.key = "k", .part = ByteRange{-3, 3}}), "expected 3 from byte");
    refused(Asked([](const RemoteRequest&) { return RemoteResponse{.status = 304}; }), "which was not asked");
    refused(Asked([](const RemoteRequest&) { return RemoteResponse{.status = 416}; }, part), "fewer bytes");
    refused(Asked([](const RemoteRequest&) { return RemoteResponse{.status = 999}; }), "status 999");
}

TEST_CASE("remote: queries go to the address that they were issued for, and nowhere else")
{
    const std::string address = take_query("https://host/signed.zarr?sig=secret");
    const Asked asked(
        [](const RemoteRequest& request) {
            if (contains(request.url, "//host/")) return RemoteResponse{.status = 302, .location = "https://other/k"};
            return RemoteResponse{.status = 500 + 5};
        },
        {.key = "k", .max_bytes = 10}, address);
    REQUIRE(asked.transport->urls.size() == 2);
    CHECK(asked.transport->urls[0] == "https://host/signed.zarr/k?sig=secret");
    CHECK(asked.transport->urls[1] == "https://other/k");
    CHECK(!contains(asked.object.failure, "secret"));
}

TEST_CASE("remote: redirects end, and are followed for their own request only")
{
    const Asked circle([](const RemoteRequest&) { return RemoteResponse{.status = 302, .location = "/k"}; });
    CHECK(contains(circle.object.failure, "redirected more than 5 times"));
    const Asked down([](const RemoteRequest&) { return RemoteResponse{.status = 302, .location = "http://host/k"}; });
    CHECK(contains(down.object.failure, "from https to http"));
    bool refuses_local = false;
    const Asked followed([&](const RemoteRequest& request) {
        refuses_local = request.refuses_local;
        if (!contains(request.url, "other")) return RemoteResponse{.status = 307, .location = "https://other/k"};
        return found(request, "x");
    });
    CHECK(followed.object.state == State::found);
    CHECK(refuses_local);
}

struct CacheFolder {
    CacheFolder() : path(std::filesystem::temp_directory_path() / sentence("shvr-remote-cache-", ::getpid())) {}
    ~CacheFolder() { std::filesystem::remove_all(path); }
    std::filesystem::path path;
};

// Kind (Servers): servers that vanish and change while objects of them are kept; kept files that are damaged
TEST_CASE("remote: kept objects are confirmed by their ETag, and taken where no server answers")
{
    const CacheFolder folder;
    const ObjectCache cache(folder.path, int64_t{1} << 20);
    bool is_up = true;
    int sent = 0, confirmed = 0;
    std::string content = "0123456789", etag = "\"1\"";
    const auto transport = std::make_shared<CannedTransport>([&](const RemoteRequest& request) {
        if (!is_up) return RemoteResponse{.failure = "refused", .may_pass = true, .is_unreached = true};
        if (request.url.ends_with("gone")) return RemoteResponse{.status = 404};
        RemoteResponse response = found(request, content, etag);
        (response.status == 304 ? confirmed : sent) += 1;
        return response;
    });
    const std::vector<RemoteWant> wants{
        {.key = "a", .max_bytes = 100}, {.key = "a", .part = ByteRange{-4, 4}}, {.key = "gone", .max_bytes = 100}};
    const auto get = [&] { return RemoteFolder("https://host/x.zarr", transport, AT_ONCE, &cache).get(wants); };
    const auto check = [&](const std::vector<RemoteObject>& objects) {
        CHECK(objects[0].bytes == bytes_of_text(content));
        CHECK(objects[1].bytes == bytes_of_text(content.substr(6)));
        CHECK(objects[1].object_bytes == 10);
        CHECK(objects[2].state == State::missing);
    };
    check(get());
    CHECK(sent == 2);
    check(get());
    CHECK(sent == 2);
    CHECK(confirmed == 2);
    content = "9876543210";
    etag = "\"2\"";
    check(get());
    CHECK(sent == 4);
    is_up = false;
    const std::vector<RemoteObject> kept = get();
    check(kept);
    CHECK(kept[0].is_offline);
    for (const auto& file : std::filesystem::recursive_directory_iterator(folder.path))
        if (file.is_regular_file() && file.file_size() > 50) std::filesystem::resize_file(file, file.file_size() - 1);
    CHECK(get()[0].state == State::failed);
    is_up = true;
    check(get());
    const RemoteFolder other("https://host/y.zarr", transport, AT_ONCE, &cache);
    is_up = false;
    CHECK(other.get(wants)[0].state == State::failed);
}

TEST_CASE("remote: the cache keeps within its budget, the most recently used")
{
    const CacheFolder folder;
    const ObjectCache cache(folder.path, 100'000);
    for (int i = 0; i < 40; ++i)
        cache.keep(sentence("object ", i), {.etag = "e", .object_bytes = 5000, .bytes = std::vector<std::byte>(5000)});
    cache.make_room();
    int64_t total = 0;
    for (const auto& file : std::filesystem::recursive_directory_iterator(folder.path))
        if (file.is_regular_file()) total += int64_t(file.file_size());
    CHECK(total <= 100'000);
    CHECK(total > 50'000);
    CHECK(cache.find("object 39", 5000));
    CHECK(!cache.find("object 0", 5000));
    CHECK(!cache.find("object 39", 4999));  // larger than its reader accepts
    const ObjectCache none(folder.path, 0);
    none.keep("object 1", {.etag = "e", .bytes = std::vector<std::byte>(1)});
    CHECK(!none.find("object 38", 5000));
}

TEST_CASE("remote: a wait that is over ends the tries")
{
    const auto transport =
        std::make_shared<CannedTransport>([](const RemoteRequest&) { return RemoteResponse{.status = 503}; });
    const RemoteFolder folder("https://host/x.zarr", transport, {.first_s = 100.0, .most_s = 100.0});
    const WaitsUntil waits([] { return true; });
    const RemoteWant want{.key = "k", .max_bytes = 10};
    CHECK_THROWS_AS(static_cast<void>(folder.get(std::span(&want, 1))), Stopped);
    CHECK(transport->rounds == 1);
}

}  // namespace
