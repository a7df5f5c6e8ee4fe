#include <doctest/doctest.h>

#include <map>

#include "engine/base/error.h"
#include "engine/formats/zarr/store/remote_store.h"
#include "tests/support/remote/canned_transport.h"

using namespace shvr;

namespace {

/// A store at https://h/x.zarr whose server has `objects`.
struct Served {
    std::map<std::string, std::string> objects{{".zattrs", "{}"}};
    std::map<std::string, std::string> etags{};
    std::map<std::string, int> statuses{};
    std::shared_ptr<CannedTransport> transport =
        std::make_shared<CannedTransport>([this](const RemoteRequest& request) {
            const std::string key = request.url.substr(std::string("https://h/x.zarr/").size());
            if (const auto status = statuses.find(key); status != statuses.end())
                return RemoteResponse{.status = status->second};
            const auto object = objects.find(key);
            if (object == objects.end()) return RemoteResponse{.status = 404};
            const auto etag = etags.find(key);
            return found(request, object->second, etag == etags.end() ? "\"1\"" : etag->second);
        });
    std::shared_ptr<const ZarrStore> open() const
    {
        return open_remote_store(RemoteFolder("https://h/x.zarr", transport, {.first_s = 0.0, .most_s = 0.0}));
    }
};

std::string refusal_of(const std::function<void()>& act)
{
    try {
        act();
    } catch (const Error& error) {
        return error.what();
    }
    return {};
}

bool contains(const std::string& text, const std::string& part)
{
    return text.find(part) != std::string::npos;
}

std::string text_of(std::span<const std::byte> bytes)
{
    return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

TEST_CASE("remote store: metadata is asked for once, all four kinds in one round")
{
    Served served;
    const auto store = served.open();
    CHECK(served.transport->rounds == 1);
    CHECK(store->has(".zattrs"));
    CHECK(!store->has("zarr.json"));
    CHECK(text_of(store->read(".zattrs", 10).value()) == "{}");
    CHECK(contains(refusal_of([&] { store->read(".zattrs", 1); }), "holds 2 bytes; expected at most 1"));
    CHECK(served.transport->rounds == 1);
    CHECK(store->is_remote());
    CHECK(store->path_of("0/1") == "https://h/x.zarr/0/1");
    CHECK(!refusal_of([&] { store->list("", [](std::string_view) { return true; }); }).empty());
}

TEST_CASE("remote store: a root that cannot be read is reported at once")
{
    Served served;
    served.objects = {};
    served.open();  // whether that is an image, its reader decides
    for (const char* const key : {"zarr.json", ".zattrs", ".zgroup", ".zarray"}) served.statuses[key] = 403;
    CHECK(contains(refusal_of([&] { served.open(); }), "access is refused (status 403)"));
    served.objects = {{".zattrs", "{}"}};
    served.statuses.erase(".zattrs");  // missing keys of a bucket that may not be listed
    CHECK(served.open()->has(".zattrs"));
    CHECK(!served.open()->has("zarr.json"));
    served.statuses["zarr.json"] = 400;
    CHECK(contains(refusal_of([&] { served.open(); }), "status 400"));
}

TEST_CASE("remote store: prepared values come in one round, near parts in one request")
{
    Served served;
    served.objects["0/0"] = "chunk";
    served.objects["0/s"] = std::string(1000, 'a') + "bcd" + std::string(100000, 'e') + "fg";
    const auto store = served.open();
    const int rounds = served.transport->rounds;
    served.transport->urls.clear();
    const std::vector<ZarrWant> wants{{.key = "0/0", .bytes = 10},
                                      {.key = "0/1", .bytes = 10},
                                      {.key = "0/s", .offset = 1002, .bytes = 1},
                                      {.key = "0/s", .offset = 1000, .bytes = 2},
                                      {.key = "0/s", .offset = 101003, .bytes = 2},
                                      {.key = "0/s", .offset = -3, .bytes = 3}};
    store->prepare(wants);
    CHECK(served.transport->rounds == rounds + 1);
    CHECK(served.transport->urls.size() == 5);
    CHECK(text_of(store->read("0/0", 10).value()) == "chunk");
    CHECK(!store->read("0/1", 10));
    std::vector<std::byte> part(2);
    store->read_part("0/s", 1000, part);
    CHECK(text_of(part) == "bc");
    store->read_part("0/s", 101003, part);
    CHECK(text_of(part) == "fg");
    part.resize(1);
    store->read_part("0/s", 1002, part);
    CHECK(text_of(part) == "d");
    const auto edge = store->read_edge("0/s", true, 3);
    CHECK(text_of(edge->bytes) == "efg");
    CHECK(edge->value_bytes == 101005);
    CHECK(served.transport->rounds == rounds + 1);
    CHECK(store->size_of("0/s") == 101005);
    CHECK(text_of(store->read("0/0", 10).value()) == "chunk");  // was taken, so it is asked for again
    CHECK(served.transport->rounds == rounds + 2);
}

TEST_CASE("remote store: failures of prepared values are reported where they are read")
{
    Served served;
    served.objects["0/0"] = "too long for a chunk";
    served.statuses["0/1"] = 403;
    const auto store = served.open();
    const std::vector<ZarrWant> wants{{.key = "0/0", .bytes = 10}, {.key = "0/1", .bytes = 10}};
    store->prepare(wants);
    CHECK(contains(refusal_of([&] { store->read("0/0", 10); }), "https://h/x.zarr/0/0: "));
    CHECK(contains(refusal_of([&] { store->read("0/1", 10); }), "https://h/x.zarr/0/1: access is refused"));
    CHECK(contains(refusal_of([&] { store->read("0/1", 10); }), "access is refused"));  // never taken for a missing one
}

// Kind (Servers): objects that change, vanish or appear while a volume is open
TEST_CASE("remote store: objects that change while the volume is open are reported")
{
    Served served;
    served.objects = {{".zattrs", "{}"}, {"0/0", "a"}, {"0/1", "b"}};
    const auto store = served.open();
    store->read("0/0", 10);
    store->read("0/0", 10);
    served.etags["0/0"] = "\"2\"";
    CHECK(contains(refusal_of([&] { store->read("0/0", 10); }), "was changed since it was first read"));
    store->read("0/1", 10);
    served.objects.erase("0/1");
    CHECK(contains(refusal_of([&] { store->read("0/1", 10); }), "was removed since it was first read"));
    CHECK(!store->read("0/2", 10));
    served.objects["0/2"] = "c";
    CHECK(contains(refusal_of([&] { store->read("0/2", 10); }), "was added since it was found missing"));
}

}  // namespace
