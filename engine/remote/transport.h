#pragma once
// Sends HTTP requests once, without retries and without following redirects: remote_folder.h does both. It is an
// interface, so that tests can replace the network by an implementation without sockets. Any thread may call these.

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace shvr {

/// Keys that sign a request (AWS Signature Version 4).
struct SigningKeys {
    std::string id{}, secret{};
    std::string token{};  ///< of temporary keys; empty: none
    std::string region{};
};

/// A range of an object's bytes: from offset `first`, or, if `first` is negative, the last bytes of the object.
struct ByteRange {
    int64_t first = 0, bytes = 0;
    bool operator==(const ByteRange&) const = default;
};

struct RemoteRequest {
    std::string url{};                  ///< may contain a credential: never printed
    std::optional<ByteRange> range{};   ///< null: the whole object
    std::string unless_etag{};          ///< If-None-Match: no body if the object has this ETag; empty: always a body
    int64_t max_bytes = 0;              ///< a longer body is refused
    const SigningKeys* keys = nullptr;  ///< null: not signed
    bool refuses_local = false;         ///< fails rather than connect to a loopback or link-local address
};

struct RemoteResponse {
    int status = 0;             ///< HTTP status; 0: no usable response, for the reason in `failure`
    std::string failure{};      ///< as in "ends after 10 of 20 bytes"; names no address
    bool may_pass = false;      ///< whether the failure may be temporary
    bool is_truncated = false;  ///< the body is longer than `max_bytes`
    std::vector<std::byte> body{};
    std::string etag{}, location{}, region{};  ///< headers; empty if absent
    std::optional<int64_t> range_first{};      ///< offset of a partial body in the object, from Content-Range
    std::optional<int64_t> object_bytes{};     ///< size of the whole object, if stated
    double retry_after_s = 0.0;
    bool is_unreached = false;   ///< no connection to the server could be made
    bool is_from_local = false;  ///< the server's address is loopback or link-local
};

class Transport {
public:
    virtual ~Transport() = default;
    /// Sends all requests, in parallel where possible, and waits for the responses. Returns them in the order of the
    /// requests. Throws `Stopped` if the wait is ended early (engine/base/waits/waits.h).
    virtual std::vector<RemoteResponse> perform(std::span<const RemoteRequest> requests) const = 0;
};

/// Returns the transport of this process, by libcurl, whose single thread carries out the requests of all threads.
std::shared_ptr<const Transport> network();

}  // namespace shvr
