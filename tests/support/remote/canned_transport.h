#pragma once
// A transport without sockets: a function answers each request.

#include <functional>
#include <mutex>
#include <string>
#include <vector>

#include "engine/remote/transport.h"

namespace shvr {

class CannedTransport final : public Transport {
public:
    using Answer = std::function<RemoteResponse(const RemoteRequest& request)>;
    explicit CannedTransport(Answer answer) : answer_(std::move(answer)) {}

    std::vector<RemoteResponse> perform(std::span<const RemoteRequest> requests) const override
    {
        const std::scoped_lock lock(mutex_);
        ++rounds;
        std::vector<RemoteResponse> responses;
        for (const RemoteRequest& request : requests) {
            urls.push_back(request.url);
            responses.push_back(answer_(request));
        }
        return responses;
    }

    mutable int rounds = 0;
    mutable std::vector<std::string> urls;

private:
    mutable std::mutex mutex_;
    Answer answer_;
};

inline std::vector<std::byte> bytes_of_text(const std::string& text)
{
    const auto* const from = reinterpret_cast<const std::byte*>(text.data());
    return {from, from + text.size()};
}

/// What a server answers that has `content` under the address of the request.
inline RemoteResponse found(const RemoteRequest& request, const std::string& content, const std::string& etag = "\"1\"")
{
    RemoteResponse response{.status = 200, .body = bytes_of_text(content), .etag = etag};
    if (!request.unless_etag.empty() && request.unless_etag == etag) return {.status = 304, .etag = etag};
    if (request.range) {
        const auto bytes = int64_t(content.size());
        const int64_t first =
            request.range->first < 0 ? std::max<int64_t>(0, bytes - request.range->bytes) : request.range->first;
        if (first >= bytes) return {.status = 416};
        response.status = 206;
        response.body = bytes_of_text(content.substr(size_t(first), size_t(request.range->bytes)));
        response.range_first = first;
        response.object_bytes = bytes;
    } else if (int64_t(content.size()) > request.max_bytes) {
        return {.failure = "the body is too long", .is_truncated = true};
    }
    return response;
}

}  // namespace shvr
