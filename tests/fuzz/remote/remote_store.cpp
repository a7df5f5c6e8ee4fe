// A server of an OME-Zarr, on a transport without sockets: the packed files are its objects, and each line of the main
// file is what it answers for one of them instead, as in
//
//     0/.zarray 206 10 500 "tag" ../elsewhere
//
// a key, a status, the first byte and the size that it states, an ETag and the target of a redirect; "-" states none.

#include <algorithm>
#include <charconv>

#include "engine/base/text.h"
#include "engine/formats/zarr/source_ome_zarr.h"
#include "engine/formats/zarr/store/remote_store.h"
#include "engine/volume/unit.h"
#include "tests/fuzz/support/attempt.h"
#include "tests/fuzz/support/input_folder.h"
#include "tests/fuzz/support/volume_input.h"
#include "tests/support/remote/canned_transport.h"

namespace {

using namespace shvr;
using namespace shvr::fuzz;

const std::string ADDRESS = "https://host/scan.zarr";
/// No more requests than this for one input: a server that asks to try again is asked five times for each object.
constexpr int MAX_REQUESTS = 20'000;

std::optional<int64_t> number_of(std::string_view word)
{
    int64_t number = 0;
    const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), number);
    return error == std::errc() && end == word.data() + word.size() ? std::optional(number) : std::nullopt;
}

struct Server {
    std::map<std::string, std::string> files;
    std::map<std::string, std::string, std::less<>> lines;  ///< the main file's lines by key
    int requests = 0;

    RemoteResponse answer(const RemoteRequest& request)
    {
        expect(++requests < MAX_REQUESTS, "requests without end");
        expect(request.url.starts_with("http"), "a request for " + request.url);
        const bool is_below = request.url.starts_with(ADDRESS + "/");
        const std::string key = is_below ? request.url.substr(ADDRESS.size() + 1) : request.url;
        const auto file = files.find(key);
        RemoteResponse response{.status = 404};
        if (file != files.end()) response = found(request, file->second);
        if (const auto line = lines.find(key); line != lines.end()) change(response, line->second);
        return response;
    }

    static void change(RemoteResponse& response, std::string_view line)
    {
        const auto words = words_of(line);
        auto word = words.begin();
        const auto next = [&] { return word == words.end() ? std::string_view() : std::string_view(*word++); };
        static_cast<void>(next());
        if (const auto status = number_of(next())) response.status = int(std::clamp<int64_t>(*status, 0, 999));
        if (const std::string_view first = next(); first != "-") response.range_first = number_of(first);
        if (const std::string_view bytes = next(); bytes != "-") response.object_bytes = number_of(bytes);
        if (const std::string_view etag = next(); etag != "-") response.etag = std::string(etag);
        response.location = std::string(next());
        response.may_pass = response.status == 0;
        response.is_unreached = response.status == 0 && response.location == "unreached";
        if (response.status == 0) response.failure = "the connection ended";
    }
};

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size)
{
    Server server;
    server.files = unpacked({data, size});
    std::string_view main = server.files[""];
    while (!main.empty()) {
        const std::string_view line = main.substr(0, main.find('\n'));
        main.remove_prefix(std::min(main.size(), line.size() + 1));
        server.lines.emplace(line.substr(0, line.find(' ')), line);
    }
    server.files.erase("");
    const auto transport =
        std::make_shared<CannedTransport>([&server](const RemoteRequest& request) { return server.answer(request); });
    std::unique_ptr<VolumeSource> source;
    const bool is_accepted = accepts([&] {
        const ZarrPlace place{
            open_remote_store(RemoteFolder(ADDRESS, transport, RetryPace{.first_s = 0.0, .most_s = 0.0}))};
        source = open_ome_zarr_at(place, ADDRESS, {});
        // open_volume makes this check after each reader.
        const glm::dvec3 spacing = source ? source->info().spacing : glm::dvec3(1.0);
        if (!glm::all(glm::greaterThanEqual(spacing, glm::dvec3(MIN_SPACING))) ||
            !glm::all(glm::lessThanEqual(spacing, glm::dvec3(MAX_SPACING))))
            fail(ADDRESS, ": has a spacing out of range");
    });
    if (is_accepted && source) try_source(*source);
    return 0;
}
